#include "compute/gpu/spirv.h"

#include <algorithm>

#include "compute/gpu/error.h"

namespace heliodon::gpu {

namespace {

// Numbers from the SPIR-V specification, only those that are read here.
enum Op : uint32_t {
    kOpName = 5,
    kOpEntryPoint = 15,
    kOpExecutionMode = 16,
    kOpTypeInt = 21,
    kOpTypeFloat = 22,
    kOpTypeVector = 23,
    kOpTypeMatrix = 24,
    kOpTypeImage = 25,
    kOpTypeSampledImage = 27,
    kOpTypeArray = 28,
    kOpTypeStruct = 30,
    kOpTypePointer = 32,
    kOpConstant = 43,
    kOpVariable = 59,
    kOpDecorate = 71,
    kOpMemberDecorate = 72,
    kOpExecutionModeId = 331,
};
enum Decoration : uint32_t { kSpecId = 1, kBinding = 33, kSet = 34, kOffset = 35 };
enum StorageClass : uint32_t { kPushConstant = 9, kStorageBuffer = 12 };

struct Instruction {
    uint32_t op = 0;
    std::span<const uint32_t> words; // operands, without the opcode word
};

struct Reader {
    std::map<uint32_t, std::string> names;
    std::map<uint32_t, Instruction> definitions; // types, constants and variables by result id
    std::map<uint32_t, std::map<uint32_t, uint32_t>> decorations;
    std::map<std::pair<uint32_t, uint32_t>, std::map<uint32_t, uint32_t>> memberDecorations;
    std::vector<uint32_t> variables;
    std::vector<Instruction> executionModes;
    SpirvModule module;

    const Instruction& at(uint32_t id) const {
        const auto found = definitions.find(id);
        if (found == definitions.end()) throw Error("SPIR-V: an id without a definition");
        return found->second;
    }

    uint32_t constant(uint32_t id) const { return at(id).words[2]; }

    uint32_t bytesOf(uint32_t type) const {
        const Instruction& t = at(type);
        switch (t.op) {
        case kOpTypeInt:
        case kOpTypeFloat:
            return t.words[1] / 8;
        case kOpTypeVector:
        case kOpTypeMatrix:
            return bytesOf(t.words[1]) * t.words[2];
        case kOpTypeArray:
            return bytesOf(t.words[1]) * constant(t.words[2]);
        case kOpTypeStruct: {
            uint32_t end = 0;
            for (uint32_t m = 0; m + 1 < t.words.size(); ++m)
                end = std::max(end, offsetOf(type, m) + bytesOf(t.words[m + 1]));
            return end;
        }
        default:
            throw Error("SPIR-V: a push constant of unexpected type");
        }
    }

    uint32_t offsetOf(uint32_t type, uint32_t member) const {
        const auto found = memberDecorations.find({type, member});
        return found == memberDecorations.end() || !found->second.contains(kOffset)
                   ? 0
                   : found->second.at(kOffset);
    }

    // Of the kinds that our shaders have: storage buffers, texel buffers to read, pictures with their
    // sampler.
    VkDescriptorType descriptorType(uint32_t storage, uint32_t type) const {
        if (storage == kStorageBuffer) return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        const bool withSampler = at(type).op == kOpTypeSampledImage;
        const Instruction& image = withSampler ? at(at(type).words[1]) : at(type);
        constexpr uint32_t kDimBuffer = 5, kReadThroughSampler = 1;
        if (image.op == kOpTypeImage && image.words[6] == kReadThroughSampler) {
            if (image.words[2] == kDimBuffer) return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
            if (withSampler) return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        }
        throw Error("SPIR-V: a kind of resource that is not used here");
    }

    void addVariable(uint32_t id) {
        const Instruction& variable = at(id);
        const uint32_t storage = variable.words[2];
        uint32_t type = at(variable.words[0]).words[2]; // what the pointer points to
        if (storage == kPushConstant) {
            module.pushConstantBytes = bytesOf(type);
            uint32_t block = type;
            if (at(block).words.size() == 2 && at(at(block).words[1]).op == kOpTypeStruct)
                block = at(block).words[1];
            for (uint32_t m = 0; m + 1 < at(block).words.size(); ++m)
                module.pushConstantOffsets.push_back(offsetOf(block, m));
            return;
        }
        const auto& decoration = decorations[id];
        if (!decoration.contains(kBinding)) return;
        if (decoration.contains(kSet) && decoration.at(kSet) != 0) throw Error("SPIR-V: only set 0 is used");
        SpirvBinding binding;
        binding.binding = decoration.at(kBinding);
        binding.name = names[id];
        if (at(type).op == kOpTypeArray) {
            binding.count = constant(at(type).words[2]);
            type = at(type).words[1];
        }
        if (binding.name.empty()) binding.name = names[type];
        binding.type = descriptorType(storage, type);
        module.bindings.push_back(binding);
    }

    // glslang gives the group size as literals up to SPIR-V 1.5, as ids of constants from 1.6 on.
    void readGroupSize(const Instruction& mode) {
        constexpr uint32_t kLocalSize = 17, kLocalSizeId = 38;
        if (mode.words.size() < 5) return;
        for (size_t axis = 0; axis < 3; ++axis) {
            if (mode.words[1] == kLocalSize) module.groupSize[axis] = mode.words[2 + axis];
            if (mode.words[1] == kLocalSizeId) module.groupSize[axis] = constant(mode.words[2 + axis]);
        }
    }
};

VkShaderStageFlagBits stageOf(uint32_t model) {
    switch (model) {
    case 0:
        return VK_SHADER_STAGE_VERTEX_BIT;
    case 3:
        return VK_SHADER_STAGE_GEOMETRY_BIT;
    case 4:
        return VK_SHADER_STAGE_FRAGMENT_BIT;
    case 5:
        return VK_SHADER_STAGE_COMPUTE_BIT;
    default:
        throw Error("SPIR-V: a stage that is not used here");
    }
}

// Of the instructions that are read.
size_t leastOperands(uint32_t op) {
    switch (op) {
    case kOpName:
    case kOpEntryPoint:
    case kOpExecutionMode:
    case kOpExecutionModeId:
    case kOpDecorate:
    case kOpTypeInt:
    case kOpTypeFloat:
    case kOpTypeSampledImage:
        return 2;
    case kOpMemberDecorate:
    case kOpVariable:
    case kOpConstant:
    case kOpTypeVector:
    case kOpTypeMatrix:
    case kOpTypeArray:
    case kOpTypePointer:
        return 3;
    case kOpTypeImage:
        return 7;
    case kOpTypeStruct:
        return 1;
    default:
        return 0;
    }
}

std::string literal(std::span<const uint32_t> words) {
    const char* text = reinterpret_cast<const char*>(words.data());
    const size_t limit = words.size() * 4;
    return std::string(text, std::find(text, text + limit, '\0'));
}

} // namespace

SpirvModule reflectSpirv(std::span<const uint32_t> words) {
    constexpr uint32_t kMagic = 0x07230203;
    if (words.size() < 5 || words[0] != kMagic) throw Error("not a SPIR-V module");
    Reader reader;
    int entryPoints = 0;
    for (size_t at = 5; at < words.size();) {
        const uint32_t op = words[at] & 0xffffu, length = words[at] >> 16;
        if (length == 0 || at + length > words.size()) throw Error("SPIR-V: a truncated instruction");
        const auto w = words.subspan(at + 1, length - 1);
        if (w.size() < leastOperands(op)) throw Error("SPIR-V: an instruction lacks operands");
        switch (op) {
        case kOpName:
            reader.names[w[0]] = literal(w.subspan(1));
            break;
        case kOpEntryPoint:
            reader.module.stage = stageOf(w[0]);
            ++entryPoints;
            break;
        case kOpExecutionMode:
        case kOpExecutionModeId:
            reader.executionModes.push_back({op, w});
            break;
        case kOpDecorate:
            reader.decorations[w[0]][w[1]] = w.size() > 2 ? w[2] : 0;
            break;
        case kOpMemberDecorate:
            reader.memberDecorations[{w[0], w[1]}][w[2]] = w.size() > 3 ? w[3] : 0;
            break;
        case kOpVariable:
            reader.variables.push_back(w[1]);
            [[fallthrough]];
        case kOpConstant:
            reader.definitions[w[1]] = {op, w};
            break;
        default:
            if (op >= kOpTypeInt && op <= kOpTypePointer) reader.definitions[w[0]] = {op, w};
        }
        at += length;
    }
    if (entryPoints != 1) throw Error("SPIR-V: not one entry point");
    for (const Instruction& mode : reader.executionModes) reader.readGroupSize(mode);
    for (uint32_t id : reader.variables) reader.addVariable(id);
    for (const auto& [id, decoration] : reader.decorations)
        if (decoration.contains(kSpecId))
            reader.module.specializationIds[reader.names[id]] = decoration.at(kSpecId);
    auto& bindings = reader.module.bindings;
    std::sort(bindings.begin(), bindings.end(),
              [](const auto& a, const auto& b) { return a.binding < b.binding; });
    return reader.module;
}

} // namespace heliodon::gpu
