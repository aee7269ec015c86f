// Khronos' glTF validator on the files named: what it finds, and an error code if there is any error.
const fs = require("fs");
const { validateBytes } = require("gltf-validator");

(async () => {
    let errors = 0;
    for (const file of process.argv.slice(2)) {
        const report = await validateBytes(new Uint8Array(fs.readFileSync(file)));
        const { numErrors, numWarnings, numInfos, messages } = report.issues;
        console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes`);
        for (const { code, message, pointer } of messages.slice(0, 10)) {
            console.log(`  ${code}: ${message} (${pointer})`);
        }
        errors += numErrors;
    }
    process.exit(errors ? 1 : 0);
})();
