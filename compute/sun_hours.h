// The sun of many hours, each clipped exactly by openings and walls: what of it falls on patches and on the
// outside of windows with blinds, and where it ends within patches. Hours follow one another in blocks of
// bounded memory, made when they are first asked for: a year that fits into one is kept, else the last block
// is held and the others are made anew when they are asked for again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"
#include "compute/daylight_transport.h"
#include "compute/sun_edges.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class SunHours {
public:
    struct Lit {
        uint32_t row;
        glm::vec3 lux;
    };
    struct Scatter { // of light before the glass
        glm::vec3 even;
        std::array<glm::vec3, daylight::kSlatLobes> lobes; // of slats
    };
    struct Hour {
        uint32_t sky; // which of the skies
        std::vector<Lit> patches;
        std::vector<Lit> bounced; // what SunBounce adds, which may be negative, but for traces
        // Blinds: light before the glass of windows, in the order of their groups, and what groups make of
        // it; no groups where no window is lit.
        std::vector<Lit> windows;
        std::vector<Scatter> groups;
        std::vector<Lit> outside; // cells of what stands outside
    };
    struct Block {
        size_t first; // of skies()
        std::span<const Hour> hours;
        const SunEdges& edges; // hours counted from `first`
    };

    // `parts`, but for its sensors, and `skies` outlive this. A block ends with the hour that fills
    // `mostBytes`; while it is made, 64 hours more are held. `done` is told how many hours more were made.
    SunHours(const TransportParts& parts, const geometry::PatchMesh& mesh,
             std::span<const daylight::Sky> skies, size_t mostBytes, std::function<void(size_t)> done = {});

    // Every block once, beginning with the one at hand; the same hours in the same blocks each time. About
    // 0.4 ms an hour and core for those that are made.
    void forBlocks(const std::function<void(const Block&)>& work);

    size_t sunny() const { return sunny_.size(); } // with the sun in the sky
    // Known after the first forBlocks: those whose sun enters, in their order, ...
    std::span<const uint32_t> skies() const { return entering_; }
    size_t blocks() const { return firsts_.size(); }
    size_t litPatches() const { return litPatches_; } // over all hours
    size_t mostBytes() const { return held_; }        // of the largest block
    double seconds() const { return seconds_; }       // taken to make blocks, again and again

private:
    struct Made {
        bool enters = false;
        Hour hour;
        std::vector<SunEdges::Edge> edges;
    };
    Made hourOf(uint32_t sky) const;
    void addBounced(std::span<const SunlitParts> partly, double strength, Made& made) const;
    void makeFirst(const std::function<void(const Block&)>& work);
    void makeAgain(size_t block);
    void hold(size_t block, std::vector<Made>& made);
    Block held() const { return {firsts_[block_], hours_, edges_}; }

    const geometry::PatchMesh* mesh_;
    const SunScene* scene_;
    const SunBounce* bounce_;
    const GlowingBlinds* blinds_;
    const OutsideReflection* reflection_;
    std::span<const daylight::Sky> skies_;
    size_t wantedBytes_;
    std::function<void(size_t)> done_;
    double area_ = 0; // of all patches
    bool made_ = false;
    std::vector<uint32_t> sunny_;
    std::vector<uint32_t> entering_;
    std::vector<size_t> firsts_; // of blocks, in entering_
    size_t litPatches_ = 0, held_ = 0, block_ = 0;
    double seconds_ = 0;
    std::vector<Hour> hours_; // of block_
    SunEdges edges_;
};

} // namespace heliodon::compute
