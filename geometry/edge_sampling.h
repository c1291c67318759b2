// Where the edges of a building are divided: once for all faces that meet there, so that no T-vertices arise.
// Uniformly at the mesh's edge length; finer only in slots and round corners with short edges or with another
// part of the outline close by, growing away from them; the two sides of a narrow strip are divided
// staggered.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/fold_leaning.h"
#include "geometry/mesh_domains.h"
#include "geometry/planar_mesher.h"
#include "geometry/slot_sizes.h"

namespace heliodon::geometry {

struct Grading {
    double first = 1.4;   // edge length at a corner, in multiples of the size of its surroundings
    double growth = 0.6;  // and how fast it grows with the distance; both infinite: uniform
    bool slots = true;    // whether they have triangles of their own sizes
    bool sparing = false; // nothing is added to round off angles beside small parts
    double narrowest = 0; // facets of curved walls, of the edge length; across smaller ones triangles lean
    double spread = 0;    // of steps, from edge to edge: equal edges are not all divided at once
};

class EdgeSampler {
public:
    // `boardRows`: per domain (board_rows.h).
    EdgeSampler(const Building& building, const std::vector<MeshDomain>& domains, SlotSizes slots,
                std::vector<uint32_t> boardRows);

    // Divides all edges anew for this edge length (metres).
    void choose(double edge, const Grading& grading);

    bool hasSlots() const;
    // Slots, strips or corners that want edges shorter than this (metres).
    bool hasSmallParts(double edge) const;

    // About how many triangles strips take that are narrower than half an edge of this length (metres).
    double narrowTriangles(double edge) const;

    // The division points of the edge from a to b without its ends, as fractions of its length from a.
    std::vector<double> divisions(uint32_t a, uint32_t b) const;

    // Of a board: steps on its first and second side, and on those opposite. It is to be a grid of so many
    // cells.
    struct Grid {
        uint32_t columns, rows;
    };
    std::optional<Grid> grid(size_t domain) const;

    // The domain with its boundary so divided, and what is known about the size of its triangles.
    PlanarDomain planar(size_t domain) const;

private:
    static constexpr uint32_t kNone = 0xffffffffu;
    struct NearCorner {
        double least;    // metres: the shortest step that it may want on the edge
        double distance; // metres from the edge
        double surroundings;
        uint32_t corner, domain;
    };
    struct SampledEdge {
        uint32_t a, b; // a < b
        double length;
        double finest; // metres: of its domains
        std::vector<uint32_t> domains;
        std::vector<double> divisions;
        // A side of a strip: in even steps, or with divisions pinned half a step off those of the other side.
        bool even = false, graded = false;
        double most = 0;                     // steps, where more would be too short beside a strip's width
        uint32_t thinIn = kNone;             // the domain in which it is the pinned side of a thin strip
        std::vector<double> pins;            // metres from a
        std::vector<NearCorner> nearCorners; // those that want the shortest steps first
    };
    // Two edges of a domain that run side by side, the shorter one first.
    struct Strip {
        uint32_t domain, side, other;
        double width;
    };
    struct TwinEdge {
        uint32_t edge;
        bool reversed;
    };
    // Edges of glasses that stand opposite one another: they have equal divisions.
    struct TwinEdges {
        std::vector<TwinEdge> edges;
        bool even = false;
    };

    void collectEdges();
    void pairTwins();
    void matchTwins(size_t from, size_t to, std::vector<std::vector<TwinEdge>>& opposite) const;
    void collectTwins(uint32_t start, const std::vector<std::vector<TwinEdge>>& opposite,
                      std::vector<bool>& seen);
    void shareDivisions(const TwinEdges& group);
    void findNearCorners(double reach);
    void findStrips();
    void considerStrip(uint32_t domain, uint32_t side, glm::dvec2 a, glm::dvec2 b, uint32_t other,
                       glm::dvec2 c, glm::dvec2 d);
    double stepIn(const Strip& strip, double edge) const; // metres, where edges are so long beside it
    void divideBoard(size_t domain);
    void divideEnds(size_t domain);
    void stagger(const Strip& strip);
    void pinBetween(const SampledEdge& lead, SampledEdge& follower) const;
    double spreadOf(const SampledEdge& edge) const; // of its steps
    void divide(SampledEdge& edge) const;
    void fillBetweenPins(SampledEdge& edge) const;
    void easeCorners();
    bool easeOnce();                                            // whether it changed anything
    bool easeGraded();                                          // likewise
    double stepAt(const SampledEdge& edge, uint32_t end) const; // metres
    // Pairs of a fraction of the edge's length and how many steps of the size wanted lie before it, whatever
    // corners of the domain `besides` want.
    std::vector<std::pair<double, double>> stepsAlong(const SampledEdge& edge, double largest,
                                                      uint32_t besides = kNone) const;
    bool sizesSlots() const { return grading_.slots && std::isfinite(grading_.growth); }
    double longestEdge(double finest) const; // metres
    // Infinity where the surroundings ask for nothing.
    double sizeOf(uint32_t corner, double surroundings) const;
    glm::dvec3 position(uint32_t corner) const { return building_.vertices[corner]; }

    const Building& building_;
    const std::vector<MeshDomain>& domains_;
    SlotSizes slots_;
    std::vector<uint32_t> boardRows_; // per domain
    FoldLeaning leaning_;
    std::vector<SampledEdge> edges_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> edgeOf_;
    std::vector<std::vector<std::vector<uint32_t>>> loopEdges_;  // per domain, loop, corner
    std::vector<std::vector<std::vector<double>>> surroundings_; // likewise (surroundings.h)
    std::vector<double> eased_;          // per corner: metres, most for the first steps from there
    std::vector<glm::dvec2> directions_; // per domain: of its longest side
    std::vector<TwinEdges> twins_;
    std::vector<Strip> strips_;   // narrow ones first, those beside them next
    double edge_ = 0, reach_ = 0; // metres; of the steps for which near corners are known
    Grading grading_;
};

} // namespace heliodon::geometry
