#include "geometry/plan_windows.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kMeets = 0.4;     // inches between markers on either side of a joint that make one window
constexpr double kTouches = 0.2;   // inches: likewise, of one wall; what is left between others is a post
constexpr double kNarrowest = 0.2; // inches
constexpr double kToCorner = 0.1;  // inches: a strip narrower than this beside a window is not worth a face
// What of a marker may lie beyond its wall without a word: markers are laid to a corner by eye. With more
// than this, and more than a quarter of the width, another window was meant than the one that is made.
constexpr double kByEye = 1.2; // inches
constexpr double kMostCut = 0.25;
constexpr double kIntoCorner = 0.375; // inches: walls reach so far beyond the corner that a room sees

struct Stretch {
    double from, to;
};

// A window on a straight side, in inches along it.
struct SideWindow {
    int line = -1;
    WindowKind kind = WindowKind::standard;
    Stretch on{};
    std::string id;
    Blind blind;
    std::string wall; // of the marker that reaches farthest
};

const WallPiece* pieceOf(const std::vector<WallPiece>& pieces, const std::string& wall) {
    for (const WallPiece& piece : pieces)
        if (std::ranges::find(piece.ids, wall) != piece.ids.end()) return &piece;
    return nullptr;
}

class WindowPlacer {
public:
    WindowPlacer(const Sketch& sketch, const PlanWalls& plan, const std::vector<WallRun>& runs,
                 const std::vector<double>& ceilings)
        : sketch_(sketch), plan_(plan), runs_(runs), ceilings_(ceilings) {}

    PlanWindows place() {
        for (const WindowMarker& marker : sketch_.windows) readMarker(marker);
        merge();
        for (const SideWindow& window : windows_) cutThrough(window);
        return std::move(out_);
    }

private:
    void note(const std::string& code, const WindowMarker& marker, const std::string& why) {
        out_.notes.push_back({code, fmt::format("window {} {}", marker.id, why)});
    }

    void readMarker(const WindowMarker& marker) {
        if (pieceOf(plan_.partitions, marker.wall))
            return note("WINDOW_ON_PARTITION", marker,
                        "is on the low wall " + marker.wall + " and is ignored");
        const WallPiece* piece = pieceOf(plan_.pieces, marker.wall);
        if (!piece) return note("WINDOW_WITHOUT_WALL", marker, "is on a wall that is ignored");
        if (piece->curved)
            return note("WINDOW_ON_ARC", marker, "is on the curved wall " + marker.wall + " and is ignored");
        const auto wall = std::ranges::find(sketch_.walls, marker.wall, &Wall::id);
        const WallLine& line = plan_.lines[static_cast<size_t>(piece->line)];
        const glm::dvec2 middle = wall->a + marker.pos * glm::normalize(wall->b - wall->a);
        const double s = line.along(middle);
        SideWindow window{piece->line, marker.kind,  {s - marker.width / 2, s + marker.width / 2},
                          marker.id,   marker.blind, marker.wall};
        if (marker.width < kNarrowest)
            return note("WINDOW_TOO_NARROW", marker, "is too narrow for a window and is ignored");
        if (onItsWall(window, marker.wall) < kNarrowest)
            return note("WINDOW_OFF_WALL", marker,
                        "does not lie on its wall " + marker.wall + " and is ignored");
        if (const double beyond = beyondWall(window); beyond > std::max(kByEye, kMostCut * marker.width))
            note("WINDOW_BEYOND_WALL", marker,
                 fmt::format("reaches {:.1f} ft beyond its wall {} and is cut to it", beyond, marker.wall));
        windows_.push_back(window);
    }

    double onItsWall(const SideWindow& window, const std::string& wall) const {
        const WallLine& line = plan_.lines[static_cast<size_t>(window.line)];
        double on = 0;
        for (const WallPiece& piece : plan_.pieces)
            if (std::ranges::find(piece.ids, wall) != piece.ids.end())
                on += std::max(0.0, std::min(window.on.to, line.along(piece.b)) -
                                        std::max(window.on.from, line.along(piece.a)));
        return on;
    }

    // How much of a window has no wall of its side behind it, or one that runs on outside the rooms. 0 where
    // no room sees the side.
    double beyondWall(const SideWindow& window) const {
        const WallLine& line = plan_.lines[static_cast<size_t>(window.line)];
        Stretch rooms{1e9, -1e9};
        for (const WallRun& run : runs_) {
            if (run.line != window.line) continue;
            const auto [low, high] = std::minmax({line.along(run.from), line.along(run.to)});
            rooms = {std::min(rooms.from, low - kIntoCorner), std::max(rooms.to, high + kIntoCorner)};
        }
        if (rooms.from > rooms.to) return 0;
        double on = 0;
        for (const Stretch& cover : covered(window.line))
            on += std::max(0.0, std::min({window.on.to, cover.to, rooms.to}) -
                                    std::max({window.on.from, cover.from, rooms.from}));
        return window.on.to - window.on.from - on;
    }

    void merge() {
        const auto order = [](const SideWindow& w) {
            return std::tuple(w.line, w.kind, w.on.from, w.on.to, w.id);
        };
        std::ranges::sort(windows_, {}, order);
        for (size_t i = 0; i + 1 < windows_.size();) {
            SideWindow &w = windows_[i], &next = windows_[i + 1];
            const double between = w.wall == next.wall ? kTouches : kMeets;
            if (w.line == next.line && w.kind == next.kind && w.blind == next.blind &&
                next.on.from <= w.on.to + between) {
                if (next.on.to > w.on.to) w.wall = next.wall;
                w.on.to = std::max(w.on.to, next.on.to);
                w.id += "+" + next.id;
                windows_.erase(windows_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
            } else
                ++i;
        }
    }

    // What walls of the side, and cracks between them, cover.
    std::vector<Stretch> covered(int id) const {
        const WallLine& line = plan_.lines[static_cast<size_t>(id)];
        std::vector<Stretch> out;
        for (const WallPiece& piece : plan_.pieces)
            if (piece.line == id) out.push_back({line.along(piece.a), line.along(piece.b)});
        std::ranges::sort(out, {}, &Stretch::from);
        for (size_t i = 0; i + 1 < out.size();)
            if (out[i + 1].from <= out[i].to + plan_.crackWidth) {
                out[i].to = std::max(out[i].to, out[i + 1].to);
                out.erase(out.begin() + static_cast<std::ptrdiff_t>(i) + 1);
            } else
                ++i;
        return out;
    }

    struct Seen {
        size_t run;
        Stretch on;
    };

    // The stretches of the window that rooms on this face of the side see.
    std::vector<Seen> seenFrom(const SideWindow& window, bool leftFace) const {
        const WallLine& line = plan_.lines[static_cast<size_t>(window.line)];
        std::vector<Seen> out;
        for (size_t r = 0; r < runs_.size(); ++r) {
            const WallRun& run = runs_[r];
            if (run.line != window.line || run.leftFace != leftFace) continue;
            const auto [low, high] = std::minmax({line.along(run.from), line.along(run.to)});
            for (const Stretch& cover : covered(window.line)) {
                Stretch on{std::max({window.on.from, low, cover.from}),
                           std::min({window.on.to, high, cover.to})};
                if (on.from < low + kToCorner) on.from = std::min(on.from, low);
                if (on.to > high - kToCorner) on.to = std::max(on.to, high);
                if (on.to - on.from >= kNarrowest) out.push_back({r, on});
            }
        }
        return out;
    }

    void cutThrough(const SideWindow& window) {
        const int before = out_.openings;
        const std::vector<Seen> right = seenFrom(window, false), left = seenFrom(window, true);
        std::vector<Stretch> shared;
        for (const Seen& r : right)
            for (const Seen& l : left) {
                const Stretch both{std::max(r.on.from, l.on.from), std::min(r.on.to, l.on.to)};
                if (both.to - both.from < kNarrowest) continue;
                add(window, {{r.run, both}, {l.run, both}});
                shared.push_back(both);
            }
        for (const std::vector<Seen>& side : {right, left})
            for (const Seen& seen : side)
                for (const Stretch& rest : without(seen.on, shared)) add(window, {{seen.run, rest}});
        if (out_.openings == before)
            out_.notes.push_back(
                {"WINDOW_OUTSIDE",
                 fmt::format("window {} is where its wall encloses nothing and is ignored", window.id)});
    }

    // What is left of a stretch outside the shared ones, a wall's thickness away from them.
    static std::vector<Stretch> without(Stretch whole, std::vector<Stretch> shared) {
        constexpr double kCrossWall = 0.5;
        if (shared.empty()) return {whole};
        std::ranges::sort(shared, {}, &Stretch::from);
        std::vector<Stretch> out;
        double from = whole.from;
        for (const Stretch& s : shared) {
            if (s.to < whole.from || s.from > whole.to) continue;
            if (s.from - kCrossWall - from >= kNarrowest) out.push_back({from, s.from - kCrossWall});
            from = std::max(from, s.to + kCrossWall);
        }
        if (whole.to - from >= kNarrowest) out.push_back({from, whole.to});
        return out;
    }

    double ceilingOf(const Seen& seen) const { return ceilings_[runs_[seen.run].room]; }

    void add(const SideWindow& window, std::vector<Seen> sides) {
        double roof = 1e9, top = 0; // of the lower room, of the higher one
        for (const Seen& seen : sides) {
            roof = std::min(roof, ceilingOf(seen));
            top = std::max(top, ceilingOf(seen));
        }
        const WallLine& line = plan_.lines[static_cast<size_t>(window.line)];
        const double middle = (sides[0].on.from + sides[0].on.to) / 2;
        bool backed = false;
        double wallTop = 0;
        for (const WallPiece& piece : plan_.pieces) {
            if (piece.line != window.line) continue;
            const double s0 = line.along(piece.a), s1 = line.along(piece.b);
            backed = backed || (middle >= s0 && middle <= s1);
            if (s1 > sides[0].on.from && s0 < sides[0].on.to) wallTop = std::max(wallTop, piece.height);
        }
        // A transom in a wall that stands above the roof of the lower room looks out over it.
        const bool clerestory = window.kind == WindowKind::transom && roof < std::min(top, wallTop);
        if (clerestory) std::erase_if(sides, [&](const Seen& seen) { return ceilingOf(seen) < top; });
        auto [sill, head] = heights(window.kind, std::min(clerestory ? top : roof, wallTop));
        if (clerestory) sill = std::max(sill, roof);
        assert(sill < head); // roofs that a wall rises above are at 8, and it is then 10 high: heads are at 9
        if (sides.size() == 2 && window.blind != Blind{})
            out_.notes.push_back({"BLINDS_INSIDE", fmt::format("window {} is between two rooms, where there "
                                                               "are no blinds: it stands open",
                                                               window.id)});
        for (const Seen& seen : sides) {
            const WallRun& run = runs_[seen.run];
            const double u = line.along(run.from), v = line.along(run.to);
            const double toRun = u < v ? 1 : -1;
            WindowHole hole;
            hole.run = seen.run;
            hole.from = toRun * ((u < v ? seen.on.from : seen.on.to) - u);
            hole.to = hole.from + (seen.on.to - seen.on.from);
            hole.sill = sill;
            hole.head = head;
            hole.opening = out_.openings;
            hole.twin = sides.size() == 2;
            hole.backed = backed;
            hole.id = window.id;
            if (!hole.twin) hole.blind = window.blind;
            out_.holes.push_back(hole);
        }
        ++out_.openings;
    }

    // Sill and head in inches (1 in = 1 ft of building) under a ceiling or wall top at `top`.
    static Stretch heights(WindowKind kind, double top) {
        switch (kind) {
        case WindowKind::standard:
            return {3, 7};
        case WindowKind::picture:
            return {1, top > 8 ? 8 : 7.5};
        case WindowKind::transom:
            break;
        }
        return top > 9 ? Stretch{7, 9} : Stretch{6, 7.5};
    }

    const Sketch& sketch_;
    const PlanWalls& plan_;
    const std::vector<WallRun>& runs_;
    const std::vector<double>& ceilings_;
    std::vector<SideWindow> windows_;
    PlanWindows out_;
};

} // namespace

std::vector<WallRun> wallRuns(const PlanWalls& plan, const std::vector<RoomPlan>& rooms) {
    std::vector<WallRun> runs;
    for (size_t r = 0; r < rooms.size(); ++r)
        for (size_t l = 0; l < rooms[r].loops.size(); ++l) {
            const OutlineLoop& loop = rooms[r].loops[l];
            const size_t n = loop.points.size();
            const auto arc = [&](size_t i) {
                const int piece = loop.edges[i % n].piece;
                return piece >= 0 && plan.pieces[static_cast<size_t>(piece)].curved ? piece : -1;
            };
            const auto straight = [&](size_t i) { // the corner at the start of edge i is no corner
                if (arc(i) >= 0 || arc(i + n - 1) >= 0) return false;
                const glm::dvec2 in = glm::normalize(loop.points[i % n] - loop.points[(i + n - 1) % n]);
                const glm::dvec2 out = glm::normalize(loop.points[(i + 1) % n] - loop.points[i % n]);
                return std::abs(cross(in, out)) < 1e-5 && glm::dot(in, out) > 0;
            };
            size_t start = 0;
            while (start < n && straight(start)) ++start;
            for (size_t i = 0; i < n;) {
                WallRun run{r, l, (start + i) % n, 1};
                run.curved = arc(run.first);
                while (i + run.count < n && straight(run.first + run.count)) ++run.count;
                run.from = loop.points[run.first];
                run.to = loop.points[(run.first + run.count) % n];
                for (size_t k = 0; k < run.count; ++k)
                    if (const int piece = loop.edges[(run.first + k) % n].piece;
                        piece >= 0 && run.curved < 0) {
                        const int line = plan.pieces[static_cast<size_t>(piece)].line;
                        const glm::dvec2 d = plan.lines[static_cast<size_t>(line)].direction;
                        if (std::abs(cross(d, glm::normalize(run.to - run.from))) > 0.1)
                            continue; // an end face
                        run.line = line;
                        // Air is on the run's left: it is the right face when it runs against the line.
                        run.leftFace = glm::dot(d, run.to - run.from) > 0;
                        break;
                    }
                i += run.count;
                runs.push_back(run);
            }
        }
    return runs;
}

PlanWindows placeWindows(const Sketch& sketch, const PlanWalls& plan, const std::vector<WallRun>& runs,
                         const std::vector<double>& ceilings) {
    return WindowPlacer(sketch, plan, runs, ceilings).place();
}

} // namespace heliodon::geometry
