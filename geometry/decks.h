// What is level in a room, by where one goes from one to the next without climbing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Patches that hang together by their edges.
struct Level {
    std::vector<size_t> patches;
    std::vector<std::pair<uint32_t, uint32_t>> border; // edges, the vertex that comes first first
    double low = std::numeric_limits<double>::infinity(), high = -low;
    double area = 0, perimeter = 0;
    Bounds box;
    bool isReached = false; // by stairs or steps

    double width() const; // of a rectangle of that area and perimeter
};

// From the lowest.
std::vector<Level> levelsOf(const PatchMesh& mesh, const std::vector<size_t>& patches);

// Levels from one to the next of which there is a step.
struct Deck {
    std::vector<Level> levels; // from the lowest
    double area = 0;
    double width = 0; // the widest level's
    bool isFloor = false, isUpper = false;
    bool mayBeTerrace = false;

    double low() const { return levels[0].low; }
    const Level& largest() const;
    std::vector<size_t> patches() const;
};

// Of a room whose mesh outlives this.
class Decks {
public:
    // `patches` look up; `scale` world metres in the mesh are one of the building.
    Decks(const PatchMesh& mesh, std::vector<size_t> patches, double scale);
    Decks(const Decks&) = delete;

    std::vector<Deck>& all() { return decks_; } // from the lowest
    // From the lowest.
    const std::vector<size_t>& patches() const { return patches_; }
    const Deck& of(size_t place) const { return decks_[deck_[place]]; } // of that patch in patches()

    struct Rise {
        double height = std::numeric_limits<double>::infinity(); // world metres
        Deck* from = nullptr;
    };
    // From the highest below a deck, among those beside it that count.
    Rise riseOf(const Deck& deck, const std::function<bool(const Deck&)>& counts);

private:
    bool areNear(size_t k, size_t other) const;
    double heightNear(size_t k, double x, double z) const;
    template<class Ask> void forNear(size_t k, double depth, const Ask& ask) const;

    const PatchMesh& mesh_;
    double scale_;
    std::vector<size_t> patches_;
    std::vector<Bounds> boxes_;  // of these
    BoxTree tree_;               // of these
    std::vector<uint32_t> deck_; // of these
    std::vector<Deck> decks_;
};

} // namespace heliodon::geometry
