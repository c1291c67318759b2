// What is drawn, on the device: meshes with the light of a frame, and solids.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "compute/gpu/buffer.h"
#include "engine/passes/draw_mesh.h"
#include "engine/passes/scene_pass.h"

namespace heliodon::passes {

// A host buffer that is rewritten each frame; grows when it must.
class FrameBuffer {
public:
    explicit FrameBuffer(std::string name) : name_(std::move(name)) {}
    template<class T> const gpu::Buffer& write(gpu::Device& device, const std::vector<T>& values) {
        const size_t bytes = values.size() * sizeof(T);
        if (!buffer_.valid() || buffer_.bytes() < bytes)
            buffer_ = gpu::Buffer(device, bytes + bytes / 2, name_, gpu::Place::host);
        if (bytes > 0) std::memcpy(buffer_.mapped<std::byte>(), values.data(), bytes);
        return buffer_;
    }
    const gpu::Buffer& buffer() const { return buffer_; }

private:
    std::string name_;
    gpu::Buffer buffer_;
};

// A mesh on the device, with the light of the frame.
struct DeviceMesh {
    DeviceMesh(gpu::Device& device, const DrawMesh& m, const std::string& name)
        : mesh(m), corners(gpu::Buffer::from(device, mesh.corners, name)), light(name + " light") {
        // Pictures of illuminance: the same corners, reflecting everything where they reflect at all.
        std::vector<DrawCorner> unit = mesh.corners;
        for (DrawCorner& corner : unit)
            corner.reflectance = glm::vec3(glm::dot(corner.reflectance, glm::vec3(1)) > 0 ? 1.0f : 0.0f);
        unitCorners = gpu::Buffer::from(device, unit, name + " unit");
    }

    void mixLight(gpu::Device& device, const std::vector<glm::vec3>& luxPerPair, float scale) {
        std::vector<glm::vec3> scaled(mesh.corners.size());
        mesh.mixLight(luxPerPair, scale, scaled);
        light.write(device, scaled);
    }
    SurfaceStreams streams(bool illuminance) const {
        return {illuminance ? &unitCorners : &corners, &light.buffer()};
    }

    const DrawMesh& mesh; // of the scene, which lives longer
    gpu::Buffer corners, unitCorners;
    FrameBuffer light;
};

struct Solid {
    Solid(gpu::Device& device, const std::vector<DrawCorner>& list, const std::string& name)
        : corners(gpu::Buffer::from(device, list, name)), count(static_cast<uint32_t>(list.size())) {}
    gpu::Buffer corners;
    uint32_t count;
};

} // namespace heliodon::passes
