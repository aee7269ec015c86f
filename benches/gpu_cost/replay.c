// Compiles pipelines for a Radeon that is not there and prints what its compiler says of them.
//
// replay DRIVER FAMILY FOLDER < JOBS: DRIVER is Mesa's libvulkan_radeon.so, FAMILY one of the names that RADV_FORCE_FAMILY knows,
// FOLDER receives the assembly as NAME.STAGE.isa. Lines of JOBS:
//   pipeline NAME SAMPLES COLORS WRITES_DEPTH
//   binding SET BINDING VK_DESCRIPTOR_TYPE COUNT
//   input LOCATION COMPONENTS KIND          KIND: 0 float, 1 signed, 2 unsigned
//   stage VK_SHADER_STAGE FILE.spv ENTRY
//   make                                    the pipeline that the lines since `pipeline` describe
// Every line of output is NAME, stage, statistic and value, tabs between them; the first one names the device and its driver.
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

#define MOST_SETS 8
#define MOST_BINDINGS 128
#define MOST_INPUTS 16
#define MOST_STAGES 2
#define MOST_COLORS 8

static PFN_vkGetInstanceProcAddr instance_function;
static PFN_vkGetDeviceProcAddr device_function;
static VkInstance instance;
static VkDevice device;
#define INSTANCE(name) ((PFN_##name)instance_function(instance, #name))
#define DEVICE(name) ((PFN_##name)device_function(device, #name))

struct job {
    char name[256];
    int samples, colors, writes_depth;
    int set_of[MOST_BINDINGS];
    VkDescriptorSetLayoutBinding bindings[MOST_BINDINGS];
    int binding_count;
    VkVertexInputAttributeDescription inputs[MOST_INPUTS];
    int input_count;
    uint32_t vertex_size;
    VkPipelineShaderStageCreateInfo stages[MOST_STAGES];
    char entries[MOST_STAGES][128];
    int stage_count;
};

static void fail(const char *what, const char *of) {
    fprintf(stderr, "replay: %s %s\n", what, of);
    exit(1);
}

static void open_device(const char *driver) {
    void *library = dlopen(driver, RTLD_NOW);
    if (!library) fail("cannot open", driver);
    uint32_t version = 5;
    VkResult (*negotiate)(uint32_t *) = (VkResult(*)(uint32_t *))dlsym(library, "vk_icdNegotiateLoaderICDInterfaceVersion");
    if (negotiate) negotiate(&version);
    instance_function = (PFN_vkGetInstanceProcAddr)dlsym(library, "vk_icdGetInstanceProcAddr");
    if (!instance_function) fail("no Vulkan driver:", driver);

    VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    if (INSTANCE(vkCreateInstance)(&create, NULL, &instance)) fail("no instance of", driver);
    uint32_t count = 1;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    INSTANCE(vkEnumeratePhysicalDevices)(instance, &count, &physical);
    if (count == 0) fail("no such family for", driver);

    VkPhysicalDeviceDriverProperties about = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &about};
    INSTANCE(vkGetPhysicalDeviceProperties2)(physical, &properties);
    printf("device\t0\t%s, %s\t0\n", properties.properties.deviceName, about.driverInfo);

    // What the driver has is switched on, as wgpu does; robust access costs instructions.
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};
    VkPhysicalDeviceRobustness2FeaturesEXT robust = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ROBUSTNESS_2_FEATURES_EXT, .pNext = &executables};
    VkPhysicalDeviceVulkan13Features f13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES, .pNext = &robust};
    VkPhysicalDeviceVulkan12Features f12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &f13};
    VkPhysicalDeviceVulkan11Features f11 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &f12};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &f11};
    INSTANCE(vkGetPhysicalDeviceFeatures2)(physical, &features);
    robust.nullDescriptor = VK_FALSE;
    if (!executables.pipelineExecutableInfo) fail("no compiler statistics from", driver);

    const char *extensions[] = {"VK_KHR_pipeline_executable_properties", "VK_EXT_robustness2"};
    float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo device_create = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &features,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = 2,
        .ppEnabledExtensionNames = extensions,
    };
    if (INSTANCE(vkCreateDevice)(physical, &device_create, NULL, &device)) fail("no device of", driver);
    device_function = INSTANCE(vkGetDeviceProcAddr);
}

static VkShaderModule load(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) fail("cannot read", path);
    fseek(file, 0, SEEK_END);
    size_t size = ftell(file);
    rewind(file);
    uint32_t *words = malloc(size);
    if (fread(words, 1, size, file) != size) fail("cannot read", path);
    fclose(file);
    VkShaderModuleCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = size, .pCode = words};
    VkShaderModule module = VK_NULL_HANDLE;
    if (DEVICE(vkCreateShaderModule)(device, &create, NULL, &module)) fail("no module of", path);
    free(words);
    return module;
}

static VkPipelineLayout layout_of(const struct job *job) {
    VkDescriptorSetLayout sets[MOST_SETS];
    int set_count = 0;
    for (int i = 0; i < job->binding_count; i++) {
        if (job->set_of[i] >= set_count) set_count = job->set_of[i] + 1;
    }
    if (set_count > MOST_SETS) fail("too many sets in", job->name);
    for (int set = 0; set < set_count; set++) {
        VkDescriptorSetLayoutBinding chosen[MOST_BINDINGS];
        uint32_t count = 0;
        for (int i = 0; i < job->binding_count; i++) {
            if (job->set_of[i] == set) chosen[count++] = job->bindings[i];
        }
        VkDescriptorSetLayoutCreateInfo create = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = count, .pBindings = chosen};
        if (DEVICE(vkCreateDescriptorSetLayout)(device, &create, NULL, &sets[set])) fail("no set layout for", job->name);
    }
    VkPipelineLayoutCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = set_count, .pSetLayouts = sets};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    if (DEVICE(vkCreatePipelineLayout)(device, &create, NULL, &layout)) fail("no layout for", job->name);
    return layout;
}

static const VkPipelineCreateFlags CAPTURE =
    VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR | VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR;

static VkPipeline make_compute(const struct job *job, VkPipelineLayout layout) {
    VkComputePipelineCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .flags = CAPTURE, .stage = job->stages[0], .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    if (DEVICE(vkCreateComputePipelines)(device, VK_NULL_HANDLE, 1, &create, NULL, &pipeline)) fail("cannot compile", job->name);
    return pipeline;
}

static VkPipeline make_graphics(const struct job *job, VkPipelineLayout layout) {
    VkVertexInputBindingDescription buffer = {0, job->vertex_size, VK_VERTEX_INPUT_RATE_VERTEX};
    VkPipelineVertexInputStateCreateInfo vertices = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = job->input_count > 0,
        .pVertexBindingDescriptions = &buffer,
        .vertexAttributeDescriptionCount = job->input_count,
        .pVertexAttributeDescriptions = job->inputs,
    };
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO, .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkViewport viewport = {0, 0, 1920, 1080, 0, 1};
    VkRect2D scissor = {{0, 0}, {1920, 1080}};
    VkPipelineViewportStateCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .pViewports = &viewport,
        .scissorCount = 1,
        .pScissors = &scissor,
    };
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO, .rasterizationSamples = job->samples};
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = job->writes_depth,
        .depthCompareOp = VK_COMPARE_OP_GREATER_OR_EQUAL,
    };
    VkPipelineColorBlendAttachmentState blends[MOST_COLORS] = {0};
    VkFormat formats[MOST_COLORS];
    for (int i = 0; i < job->colors; i++) {
        blends[i].colorWriteMask = 15;
        formats[i] = VK_FORMAT_R16G16B16A16_SFLOAT;
    }
    VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, .attachmentCount = job->colors, .pAttachments = blends};
    VkPipelineRenderingCreateInfo targets = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = job->colors,
        .pColorAttachmentFormats = formats,
        .depthAttachmentFormat = VK_FORMAT_D32_SFLOAT,
    };
    VkGraphicsPipelineCreateInfo create = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &targets,
        .flags = CAPTURE,
        .stageCount = job->stage_count,
        .pStages = job->stages,
        .pVertexInputState = &vertices,
        .pInputAssemblyState = &assembly,
        .pViewportState = &view,
        .pRasterizationState = &raster,
        .pMultisampleState = &samples,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .layout = layout,
    };
    VkPipeline pipeline = VK_NULL_HANDLE;
    if (DEVICE(vkCreateGraphicsPipelines)(device, VK_NULL_HANDLE, 1, &create, NULL, &pipeline)) fail("cannot compile", job->name);
    return pipeline;
}

static void describe(const struct job *job, VkPipeline pipeline, const char *folder) {
    VkPipelineInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = pipeline};
    VkPipelineExecutablePropertiesKHR stages[8];
    uint32_t stage_count = 8;
    for (int i = 0; i < 8; i++) stages[i] = (VkPipelineExecutablePropertiesKHR){.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR};
    DEVICE(vkGetPipelineExecutablePropertiesKHR)(device, &info, &stage_count, stages);
    for (uint32_t s = 0; s < stage_count; s++) {
        VkPipelineExecutableInfoKHR stage = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, .pipeline = pipeline, .executableIndex = s};
        VkPipelineExecutableStatisticKHR statistics[64];
        uint32_t count = 64;
        for (int i = 0; i < 64; i++) statistics[i] = (VkPipelineExecutableStatisticKHR){.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR};
        DEVICE(vkGetPipelineExecutableStatisticsKHR)(device, &stage, &count, statistics);
        for (uint32_t i = 0; i < count; i++) {
            if (statistics[i].format != VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR) continue;
            printf("%s\t%u\t%s\t%llu\n", job->name, stages[s].stages, statistics[i].name, (unsigned long long)statistics[i].value.u64);
        }
        // Asked for the sizes first, then for the texts.
        VkPipelineExecutableInternalRepresentationKHR texts[8];
        count = 8;
        for (int i = 0; i < 8; i++) texts[i] = (VkPipelineExecutableInternalRepresentationKHR){.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INTERNAL_REPRESENTATION_KHR};
        DEVICE(vkGetPipelineExecutableInternalRepresentationsKHR)(device, &stage, &count, texts);
        for (uint32_t i = 0; i < count; i++) texts[i].pData = calloc(1, texts[i].dataSize + 1);
        DEVICE(vkGetPipelineExecutableInternalRepresentationsKHR)(device, &stage, &count, texts);
        for (uint32_t i = 0; i < count; i++) {
            if (strstr(texts[i].name, "ssembly")) {
                char path[1024];
                snprintf(path, sizeof path, "%s/%s.%u.isa", folder, job->name, stages[s].stages);
                FILE *file = fopen(path, "w");
                if (!file) fail("cannot write", path);
                fputs(texts[i].pData, file);
                fclose(file);
            }
            free(texts[i].pData);
        }
    }
    fflush(stdout);
}

int main(int argc, char **argv) {
    if (argc != 4) fail("usage:", "replay DRIVER FAMILY FOLDER < JOBS");
    setenv("RADV_FORCE_FAMILY", argv[2], 1);
    open_device(argv[1]);
    static const VkFormat FORMATS[3][4] = {
        {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT},
        {VK_FORMAT_R32_SINT, VK_FORMAT_R32G32_SINT, VK_FORMAT_R32G32B32_SINT, VK_FORMAT_R32G32B32A32_SINT},
        {VK_FORMAT_R32_UINT, VK_FORMAT_R32G32_UINT, VK_FORMAT_R32G32B32_UINT, VK_FORMAT_R32G32B32A32_UINT},
    };
    static struct job job;
    char line[2048], path[1024];
    while (fgets(line, sizeof line, stdin)) {
        unsigned a, b, c, d;
        if (!strncmp(line, "pipeline ", 9)) {
            memset(&job, 0, sizeof job);
            if (sscanf(line, "pipeline %255s %d %d %d", job.name, &job.samples, &job.colors, &job.writes_depth) != 4 || job.colors > MOST_COLORS) fail("bad line:", line);
        } else if (sscanf(line, "binding %u %u %u %u", &a, &b, &c, &d) == 4) {
            if (job.binding_count == MOST_BINDINGS) fail("too many bindings in", job.name);
            job.set_of[job.binding_count] = a;
            job.bindings[job.binding_count++] = (VkDescriptorSetLayoutBinding){b, c, d, VK_SHADER_STAGE_ALL, NULL};
        } else if (sscanf(line, "input %u %u %u", &a, &b, &c) == 3) {
            if (job.input_count == MOST_INPUTS || b < 1 || b > 4 || c > 2) fail("bad line:", line);
            job.inputs[job.input_count++] = (VkVertexInputAttributeDescription){a, 0, FORMATS[c][b - 1], job.vertex_size};
            job.vertex_size += 4 * b;
        } else if (!strncmp(line, "stage ", 6)) {
            if (job.stage_count == MOST_STAGES) fail("too many stages in", job.name);
            char *entry = job.entries[job.stage_count];
            if (sscanf(line, "stage %u %1023s %127s", &a, path, entry) != 3) fail("bad line:", line);
            job.stages[job.stage_count++] = (VkPipelineShaderStageCreateInfo){
                .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = a, .module = load(path), .pName = entry};
        } else if (!strncmp(line, "make", 4) && job.stage_count > 0) {
            VkPipelineLayout layout = layout_of(&job);
            int compute = job.stages[0].stage == VK_SHADER_STAGE_COMPUTE_BIT;
            VkPipeline pipeline = compute ? make_compute(&job, layout) : make_graphics(&job, layout);
            describe(&job, pipeline, argv[3]);
            DEVICE(vkDestroyPipeline)(device, pipeline, NULL);
        } else {
            fail("bad line:", line);
        }
    }
    // Tearing down a device without hardware is not what its driver is tested for.
    fflush(stdout);
    _exit(0);
}
