// A Vulkan layer that lets a program's shaders be counted (`gpu_cost --pictures`): every pipeline's SPIR-V and layout is written into a
// folder, GPU_COST_FOLDER, the program waits until `gpu_cost` has put counters into it, and the software driver gets the counted code.
// What each frame added to the counters is written at the next submission.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#define MOST_HANDLES 65536
#define MOST_BINDINGS 160
#define MOST_SETS 8
#define MOST_STAGES 3
// As in crates/plumage_tools/src/bin/gpu_cost/instrument.rs: words of counters, then two images of a word a pixel.
#define COUNTER_WORDS (1u << 20)
#define COUNTER_BYTES ((uint64_t)(COUNTER_WORDS + 2u * 2048u * 2048u) * 4u)
// Stands in the counted code for the address of the counters.
#define MAGIC 0x5eedc0deu

struct layout {
    int count;
    VkDescriptorSetLayoutBinding bindings[MOST_BINDINGS];
};
struct entry {
    uint64_t handle;
    void *data;
    size_t size;
};
static struct entry entries[MOST_HANDLES];
static int entry_count;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static PFN_vkGetInstanceProcAddr next_instance;
static PFN_vkGetDeviceProcAddr next_device;
static VkInstance the_instance;
static VkDevice the_device;
static uint32_t *counters;
static uint64_t counters_at;
static uint32_t *seen;
static int pipeline_count;
#define NEXT(name) ((PFN_##name)next_device(the_device, #name))

static void keep(uint64_t handle, const void *data, size_t size) {
    pthread_mutex_lock(&lock);
    struct entry *found = NULL;
    for (int i = 0; i < entry_count; i++) {
        if (entries[i].handle == handle) found = &entries[i];
    }
    if (!found && entry_count < MOST_HANDLES) found = &entries[entry_count++];
    if (found) {
        free(found->data);
        found->handle = handle;
        found->data = malloc(size);
        found->size = size;
        memcpy(found->data, data, size);
    }
    pthread_mutex_unlock(&lock);
}

static struct entry find(uint64_t handle) {
    pthread_mutex_lock(&lock);
    struct entry found = {0};
    for (int i = 0; i < entry_count; i++) {
        if (entries[i].handle == handle) found = entries[i];
    }
    pthread_mutex_unlock(&lock);
    return found;
}

static FILE *open_file(const char *name, const char *mode) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", getenv("GPU_COST_FOLDER"), name);
    FILE *file = fopen(path, mode);
    if (!file) {
        fprintf(stderr, "layer: cannot open %s\n", path);
        exit(1);
    }
    return file;
}

static void make_counters(VkPhysicalDevice physical) {
    VkBufferCreateInfo buffer_create = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = COUNTER_BYTES,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
    };
    VkBuffer buffer;
    if (NEXT(vkCreateBuffer)(the_device, &buffer_create, NULL, &buffer)) return;
    VkMemoryRequirements needs;
    NEXT(vkGetBufferMemoryRequirements)(the_device, buffer, &needs);
    VkPhysicalDeviceMemoryProperties kinds;
    ((PFN_vkGetPhysicalDeviceMemoryProperties)next_instance(the_instance, "vkGetPhysicalDeviceMemoryProperties"))(physical, &kinds);
    VkMemoryAllocateFlagsInfo flags = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO, .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .pNext = &flags, .allocationSize = needs.size};
    const VkMemoryPropertyFlags seen_by_both = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (uint32_t i = kinds.memoryTypeCount; i-- > 0;) {
        int fits = needs.memoryTypeBits >> i & 1;
        if (fits && (kinds.memoryTypes[i].propertyFlags & seen_by_both) == seen_by_both) allocate.memoryTypeIndex = i;
    }
    VkDeviceMemory memory;
    if (NEXT(vkAllocateMemory)(the_device, &allocate, NULL, &memory)) return;
    NEXT(vkBindBufferMemory)(the_device, buffer, memory, 0);
    void *mapped;
    if (NEXT(vkMapMemory)(the_device, memory, 0, VK_WHOLE_SIZE, 0, &mapped)) return;
    memset(mapped, 0, COUNTER_BYTES);
    VkBufferDeviceAddressInfo of = {.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, .buffer = buffer};
    counters_at = NEXT(vkGetBufferDeviceAddress)(the_device, &of);
    counters = mapped;
    seen = calloc(COUNTER_WORDS, 4);
}

// What earlier work added, one line a counter after a line `submission`; the images behind the counters begin anew.
static void take_stock(void) {
    if (!counters) return;
    FILE *file = NULL;
    for (uint32_t i = 0; i < COUNTER_WORDS; i++) {
        uint32_t now = counters[i];
        if (now == seen[i]) continue;
        if (!file) {
            file = open_file("counts", "a");
            fprintf(file, "submission\n");
        }
        fprintf(file, "%u %u\n", i, now - seen[i]);
        seen[i] = now;
    }
    if (file) {
        fclose(file);
        memset(counters + COUNTER_WORDS, 0, COUNTER_BYTES - 4ull * COUNTER_WORDS);
    }
}

static void write_stage(int index, const VkPipelineShaderStageCreateInfo *stage, FILE *about) {
    char name[64];
    struct entry code = find((uint64_t)stage->module);
    snprintf(name, sizeof name, "%d.%d.spv", index, stage->stage);
    FILE *file = open_file(name, "wb");
    fwrite(code.data, 1, code.size, file);
    fclose(file);
    fprintf(about, "stage %d %s\n", stage->stage, stage->pName);
}

static void write_layout(VkPipelineLayout layout, FILE *about) {
    struct entry sets = find((uint64_t)layout);
    for (size_t set = 0; set < sets.size / sizeof(uint64_t); set++) {
        const struct layout *found = find(((uint64_t *)sets.data)[set]).data;
        for (int i = 0; found && i < found->count; i++) {
            const VkDescriptorSetLayoutBinding *b = &found->bindings[i];
            fprintf(about, "binding %zu %u %u %u\n", set, b->binding, b->descriptorType, b->descriptorCount);
        }
    }
}

// Says that a pipeline is written, and waits for its counted code.
static void hand_over(int index) {
    char from[1100], to[1100];
    const char *folder = getenv("GPU_COST_FOLDER");
    snprintf(from, sizeof from, "%s/%d.part", folder, index);
    snprintf(to, sizeof to, "%s/%d.made", folder, index);
    rename(from, to);
    snprintf(to, sizeof to, "%s/%d.counted", folder, index);
    struct stat there;
    for (int turn = 0; turn < 12000 && stat(to, &there); turn++) usleep(5000);
}

// The counted code of a stage as a module, or none.
static VkShaderModule counted(int index, int stage) {
    char path[1100];
    snprintf(path, sizeof path, "%s/%d.%d.counted.spv", getenv("GPU_COST_FOLDER"), index, stage);
    FILE *file = counters_at ? fopen(path, "rb") : NULL;
    if (!file) return VK_NULL_HANDLE;
    fseek(file, 0, SEEK_END);
    size_t size = ftell(file);
    rewind(file);
    uint32_t *words = malloc(size);
    size_t got = fread(words, 1, size, file);
    fclose(file);
    for (size_t i = 0; i + 1 < got / 4; i++) {
        if (words[i] == MAGIC && words[i + 1] == MAGIC) {
            words[i] = (uint32_t)counters_at;
            words[i + 1] = (uint32_t)(counters_at >> 32);
        }
    }
    VkShaderModuleCreateInfo create = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = got, .pCode = words};
    VkShaderModule module = VK_NULL_HANDLE;
    NEXT(vkCreateShaderModule)(the_device, &create, NULL, &module);
    free(words);
    return module;
}

static FILE *begin(int index) {
    char name[64];
    snprintf(name, sizeof name, "%d.part", index);
    return open_file(name, "w");
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateShaderModule(
    VkDevice device, const VkShaderModuleCreateInfo *create, const VkAllocationCallbacks *allocator, VkShaderModule *module) {
    VkResult result = NEXT(vkCreateShaderModule)(device, create, allocator, module);
    if (!result) keep((uint64_t)*module, create->pCode, create->codeSize);
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateDescriptorSetLayout(
    VkDevice device, const VkDescriptorSetLayoutCreateInfo *create, const VkAllocationCallbacks *allocator, VkDescriptorSetLayout *layout) {
    VkResult result = NEXT(vkCreateDescriptorSetLayout)(device, create, allocator, layout);
    if (!result) {
        struct layout own = {0};
        for (uint32_t i = 0; i < create->bindingCount && i < MOST_BINDINGS; i++) own.bindings[own.count++] = create->pBindings[i];
        keep((uint64_t)*layout, &own, sizeof own);
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL CreatePipelineLayout(
    VkDevice device, const VkPipelineLayoutCreateInfo *create, const VkAllocationCallbacks *allocator, VkPipelineLayout *layout) {
    VkResult result = NEXT(vkCreatePipelineLayout)(device, create, allocator, layout);
    if (!result) keep((uint64_t)*layout, create->pSetLayouts, create->setLayoutCount * sizeof(uint64_t));
    return result;
}

static VkResult make_graphics(VkPipelineCache cache, const VkGraphicsPipelineCreateInfo *asked, const VkAllocationCallbacks *allocator, VkPipeline *pipeline) {
    pthread_mutex_lock(&lock);
    int index = pipeline_count++;
    pthread_mutex_unlock(&lock);
    FILE *about = begin(index);
    const VkPipelineMultisampleStateCreateInfo *samples = asked->pMultisampleState;
    const VkPipelineDepthStencilStateCreateInfo *depth = asked->pDepthStencilState;
    const VkPipelineColorBlendStateCreateInfo *blend = asked->pColorBlendState;
    const VkPipelineRasterizationStateCreateInfo *raster = asked->pRasterizationState;
    fprintf(about, "state %d %d %d %d %d\n", samples ? samples->rasterizationSamples : 1, blend ? (int)blend->attachmentCount : 0,
            depth && depth->depthTestEnable, depth && depth->depthWriteEnable, raster && raster->depthClampEnable);
    VkPipelineShaderStageCreateInfo stages[MOST_STAGES];
    uint32_t count = 0;
    for (; count < asked->stageCount && count < MOST_STAGES - 1; count++) {
        stages[count] = asked->pStages[count];
        write_stage(index, &stages[count], about);
    }
    const VkPipelineVertexInputStateCreateInfo *inputs = asked->pVertexInputState;
    for (uint32_t i = 0; inputs && i < inputs->vertexAttributeDescriptionCount; i++) {
        const VkVertexInputAttributeDescription *input = &inputs->pVertexAttributeDescriptions[i];
        fprintf(about, "input %u %d\n", input->location, input->format);
    }
    write_layout(asked->layout, about);
    fclose(about);
    hand_over(index);
    int has_fragments = 0;
    for (uint32_t i = 0; i < count; i++) {
        has_fragments |= stages[i].stage == VK_SHADER_STAGE_FRAGMENT_BIT;
        VkShaderModule module = counted(index, stages[i].stage);
        if (module) stages[i].module = module;
    }
    // A pipeline of depth alone gets a stage that counts.
    VkShaderModule module = has_fragments ? VK_NULL_HANDLE : counted(index, VK_SHADER_STAGE_FRAGMENT_BIT);
    if (module) {
        stages[count++] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = VK_SHADER_STAGE_FRAGMENT_BIT, .module = module, .pName = "count"};
    }
    VkGraphicsPipelineCreateInfo create = *asked;
    create.pStages = stages;
    create.stageCount = count;
    return NEXT(vkCreateGraphicsPipelines)(the_device, cache, 1, &create, allocator, pipeline);
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateGraphicsPipelines(
    VkDevice device, VkPipelineCache cache, uint32_t count, const VkGraphicsPipelineCreateInfo *asked, const VkAllocationCallbacks *allocator,
    VkPipeline *pipelines) {
    (void)device;
    for (uint32_t i = 0; i < count; i++) {
        VkResult result = make_graphics(cache, &asked[i], allocator, &pipelines[i]);
        if (result) return result;
    }
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateComputePipelines(
    VkDevice device, VkPipelineCache cache, uint32_t count, const VkComputePipelineCreateInfo *asked, const VkAllocationCallbacks *allocator,
    VkPipeline *pipelines) {
    for (uint32_t i = 0; i < count; i++) {
        pthread_mutex_lock(&lock);
        int index = pipeline_count++;
        pthread_mutex_unlock(&lock);
        FILE *about = begin(index);
        fprintf(about, "state 1 0 0 0 0\n");
        write_stage(index, &asked[i].stage, about);
        write_layout(asked[i].layout, about);
        fclose(about);
        hand_over(index);
        VkComputePipelineCreateInfo create = asked[i];
        VkShaderModule module = counted(index, VK_SHADER_STAGE_COMPUTE_BIT);
        if (module) create.stage.module = module;
        VkResult result = NEXT(vkCreateComputePipelines)(device, cache, 1, &create, allocator, &pipelines[i]);
        if (result) return result;
    }
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL QueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos, VkFence fence) {
    pthread_mutex_lock(&lock);
    take_stock();
    pthread_mutex_unlock(&lock);
    return NEXT(vkQueueSubmit)(queue, count, infos, fence);
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateInstance(
    const VkInstanceCreateInfo *create, const VkAllocationCallbacks *allocator, VkInstance *instance) {
    VkLayerInstanceCreateInfo *link = (VkLayerInstanceCreateInfo *)create->pNext;
    while (link && !(link->sType == VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO && link->function == VK_LAYER_LINK_INFO)) link = (VkLayerInstanceCreateInfo *)link->pNext;
    if (!link) return VK_ERROR_INITIALIZATION_FAILED;
    next_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    VkResult result = ((PFN_vkCreateInstance)next_instance(NULL, "vkCreateInstance"))(create, allocator, instance);
    the_instance = *instance;
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateDevice(
    VkPhysicalDevice physical, const VkDeviceCreateInfo *create, const VkAllocationCallbacks *allocator, VkDevice *device) {
    VkLayerDeviceCreateInfo *link = (VkLayerDeviceCreateInfo *)create->pNext;
    while (link && !(link->sType == VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO && link->function == VK_LAYER_LINK_INFO)) link = (VkLayerDeviceCreateInfo *)link->pNext;
    if (!link) return VK_ERROR_INITIALIZATION_FAILED;
    PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    next_device = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    VkResult result = ((PFN_vkCreateDevice)get(the_instance, "vkCreateDevice"))(physical, create, allocator, device);
    if (result) return result;
    the_device = *device;
    make_counters(physical);
    if (!counters_at) fprintf(stderr, "layer: no counters\n");
    return result;
}

static PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char *name);
#define HOOK(function) if (!strcmp(name, "vk" #function)) return (PFN_vkVoidFunction)function
static PFN_vkVoidFunction hook(const char *name) {
    HOOK(CreateShaderModule);
    HOOK(CreateDescriptorSetLayout);
    HOOK(CreatePipelineLayout);
    HOOK(CreateGraphicsPipelines);
    HOOK(CreateComputePipelines);
    HOOK(QueueSubmit);
    if (!strcmp(name, "vkGetDeviceProcAddr")) return (PFN_vkVoidFunction)device_function;
    return NULL;
}

static PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char *name) {
    PFN_vkVoidFunction own = hook(name);
    return own ? own : next_device(device, name);
}

static PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char *name) {
    HOOK(CreateInstance);
    HOOK(CreateDevice);
    if (!strcmp(name, "vkGetInstanceProcAddr")) return (PFN_vkVoidFunction)instance_function;
    if (!instance) return NULL;
    PFN_vkVoidFunction own = hook(name);
    return own ? own : next_instance(instance, name);
}

__attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *about) {
    about->loaderLayerInterfaceVersion = 2;
    about->pfnGetInstanceProcAddr = instance_function;
    about->pfnGetDeviceProcAddr = device_function;
    about->pfnGetPhysicalDeviceProcAddr = NULL;
    return VK_SUCCESS;
}
