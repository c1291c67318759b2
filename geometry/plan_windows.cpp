#include "geometry/plan_windows.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/facing_walls.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kMeets = 0.4;     // inches between markers on either side of a joint that make one window
constexpr double kTouches = 0.2;   // inches: likewise, of one wall; what is left between others is a post
constexpr double kNarrowest = 0.2; // inches
constexpr double kCrossWall =
    0.5; // inches, a wall's thickness and more, between windows to either side of its end
constexpr double kToCorner = 0.1; // inches: a strip narrower than this beside a window is not worth a face
// What of a marker may lie beyond its wall without a word: markers are laid to a corner by eye. With more
// than this, and more than a quarter of the width, another window was meant than the one that is made.
constexpr double kByEye = 1.2; // inches
constexpr double kMostCut = 0.25;

// A window on a straight side, in inches along it.
struct SideWindow {
    int line = -1;
    WindowKind kind = WindowKind::standard;
    Stretch on{};
    std::string id;
    Blind blind;
    std::string wall;         // of the marker that reaches farthest
    bool outerLayer = false;  // the marker is on another wall, before that of the room
    std::vector<size_t> cuts; // notes that it is cut to its wall
};

auto order(const SideWindow& w) {
    return std::tuple(w.line, w.kind, w.on.from, w.on.to, w.id);
}

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
        pairLayers();
        merge();
        for (const SideWindow& window : windows_) cutThrough(window);
        lookAtWallsBefore();
        for (const Opening& opening : openings_) add(opening);
        std::erase_if(out_.notes, [](const PlanNote& one) { return one.code.empty(); });
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
        if (!isSeen(plan_, runs_, window.line, window.on)) moveToRoom(window);
        if (const double beyond = beyondWall(window); beyond > std::max(kByEye, kMostCut * marker.width)) {
            window.cuts = {out_.notes.size()};
            note("WINDOW_BEYOND_WALL", marker,
                 fmt::format("reaches {:.1f} ft beyond its wall {} and is cut to it", beyond, marker.wall));
        }
        windows_.push_back(window);
    }

    // On the outer layer of a room's wall it is a window of that wall.
    void moveToRoom(SideWindow& window) const {
        const WallLine& line = plan_.lines[static_cast<size_t>(window.line)];
        for (const WallRun& run : runs_) {
            if (run.line < 0) continue;
            const Stretch on = alongOther(line, window.on, plan_.lines[static_cast<size_t>(run.line)]);
            for (const FacingWall& wall : wallsBefore(plan_, runs_, run, on)) {
                if (wall.line != window.line || !isLayerOver(on, run, wall)) continue;
                window.line = run.line;
                window.on = on;
                window.outerLayer = true;
                return;
            }
        }
    }

    // Over all of it but what may be lost by eye: a wall that ends before a window may stand there for
    // itself.
    bool isLayerOver(Stretch on, const WallRun& run, const FacingWall& wall) const {
        return wall.on.length() >= (1 - kMostCut) * on.length() && isOuterLayer(plan_, runs_, run, wall);
    }

    // Markers on both layers of a wall that face one another are one window where both are.
    void pairLayers() {
        std::ranges::sort(windows_, {}, order);
        for (size_t i = 0; i < windows_.size();) {
            const SideWindow outer = windows_[i];
            const auto inner = std::ranges::find_if(windows_, [&](const SideWindow& w) {
                return outer.outerLayer && !w.outerLayer && w.line == outer.line && w.kind == outer.kind &&
                       common(w.on, outer.on).length() >= kNarrowest;
            });
            if (inner == windows_.end()) {
                ++i;
                continue;
            }
            const Stretch both = common(inner->on, outer.on);
            const double longest = std::max(inner->on.length(), outer.on.length());
            if (longest - both.length() > std::max(kByEye, kMostCut * longest))
                out_.notes.push_back({"WINDOW_BEFORE_WALL",
                                      fmt::format("windows {} and {} are on two layers of one wall and face "
                                                  "one another in part: the rest is walled up",
                                                  inner->id, outer.id)});
            inner->on = both;
            inner->id += "+" + outer.id;
            inner->cuts.insert(inner->cuts.end(), outer.cuts.begin(), outer.cuts.end());
            windows_.erase(windows_.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }

    static Stretch common(Stretch a, Stretch b) { return {std::max(a.from, b.from), std::min(a.to, b.to)}; }

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
        for (const Stretch& cover : coveredStretches(plan_, window.line))
            on += std::max(0.0, std::min({window.on.to, cover.to, rooms.to}) -
                                    std::max({window.on.from, cover.from, rooms.from}));
        return window.on.to - window.on.from - on;
    }

    void merge() {
        std::ranges::sort(windows_, {}, order);
        for (size_t i = 0; i + 1 < windows_.size();) {
            SideWindow &w = windows_[i], &next = windows_[i + 1];
            const double between = w.wall == next.wall ? kTouches : kMeets;
            if (w.line == next.line && w.kind == next.kind && w.blind == next.blind &&
                next.on.from <= w.on.to + between) {
                if (next.on.to > w.on.to) w.wall = next.wall;
                w.on.to = std::max(w.on.to, next.on.to);
                w.id += "+" + next.id;
                w.cuts.insert(w.cuts.end(), next.cuts.begin(), next.cuts.end());
                windows_.erase(windows_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
            } else
                ++i;
        }
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
            for (const Stretch& cover : coveredStretches(plan_, window.line)) {
                Stretch on{std::max({window.on.from, low, cover.from}),
                           std::min({window.on.to, high, cover.to})};
                if (on.from < low + kToCorner) on.from = std::min(on.from, low);
                if (on.to > high - kToCorner) on.to = std::max(on.to, high);
                if (on.to - on.from >= kNarrowest) out.push_back({r, on});
            }
        }
        return out;
    }

    // A part of a window that one room sees, or one between two rooms.
    struct Opening {
        const SideWindow* window;
        std::vector<Seen> sides;
        const SideWindow* opposite = nullptr; // of the second side, where that is a wall of its own
        double hidden = 0;                    // inches: nothing is seen below
    };

    void cutThrough(const SideWindow& window) {
        const size_t before = openings_.size();
        const std::vector<Seen> right = seenFrom(window, false), left = seenFrom(window, true);
        std::vector<Stretch> shared;
        for (const Seen& r : right)
            for (const Seen& l : left) {
                const Stretch both{std::max(r.on.from, l.on.from), std::min(r.on.to, l.on.to)};
                if (both.to - both.from < kNarrowest) continue;
                openings_.push_back({&window, {{r.run, both}, {l.run, both}}});
                shared.push_back(both);
            }
        for (const std::vector<Seen>& side : {right, left})
            for (const Seen& seen : side)
                for (const Stretch& rest : without(seen.on, shared, kCrossWall))
                    openings_.push_back({&window, {{seen.run, rest}}});
        if (openings_.size() > before) return;
        for (const size_t k : window.cuts) out_.notes[k].code.clear(); // taken back
        out_.notes.push_back(
            {"WINDOW_OUTSIDE",
             fmt::format("window {} is where its wall encloses nothing and is ignored", window.id)});
    }

    // What is left of a stretch outside the shared ones, so far away from them.
    static std::vector<Stretch> without(Stretch whole, std::vector<Stretch> shared, double apart) {
        if (shared.empty()) return {whole};
        std::ranges::sort(shared, {}, &Stretch::from);
        std::vector<Stretch> out;
        double from = whole.from;
        for (const Stretch& s : shared) {
            if (s.to < whole.from || s.from > whole.to) continue;
            if (s.from - apart - from >= kNarrowest) out.push_back({from, s.from - apart});
            from = std::max(from, s.to + apart);
        }
        if (whole.to - from >= kNarrowest) out.push_back({from, whole.to});
        return out;
    }

    double ceilingOf(const Seen& seen) const { return ceilings_[runs_[seen.run].room]; }

    const WallLine& lineOf(const Seen& seen) const {
        return plan_.lines[static_cast<size_t>(runs_[seen.run].line)];
    }

    double wallTop(const Seen& seen) const {
        double top = 0;
        for (const WallPiece& piece : plan_.pieces)
            if (piece.line == runs_[seen.run].line && lineOf(seen).along(piece.b) > seen.on.from &&
                lineOf(seen).along(piece.a) < seen.on.to)
                top = std::max(top, piece.height);
        return top;
    }

    bool isBacked(const Seen& seen) const {
        const double middle = (seen.on.from + seen.on.to) / 2;
        return std::ranges::any_of(plan_.pieces, [&](const WallPiece& piece) {
            return piece.line == runs_[seen.run].line && middle >= lineOf(seen).along(piece.a) &&
                   middle <= lineOf(seen).along(piece.b);
        });
    }

    // Sill and head under the ceilings and tops of walls of both sides.
    Stretch extentOf(const Opening& opening) const {
        double top = 1e9;
        for (const Seen& seen : opening.sides) top = std::min({top, ceilingOf(seen), wallTop(seen)});
        Stretch out = heights(opening.window->kind, top);
        if (opening.opposite) {
            const Stretch other = heights(opening.opposite->kind, top);
            out = {std::max(out.from, other.from), std::min(out.to, other.to)};
        }
        return {std::max(out.from, opening.hidden), out.to};
    }

    bool looksOver(Opening opening, const FacingWall& wall) const {
        opening.hidden = wall.height;
        return extentOf(opening).length() >= kNarrowest;
    }

    // One through both walls, where the two windows look at one another's wall.
    std::optional<Opening> joined(const Opening& near, const std::vector<FacingWall>& beforeNear,
                                  const Opening& far, const std::vector<FacingWall>& beforeFar) const {
        const Seen &n = near.sides[0], &f = far.sides[0];
        const auto hides = [&](const Opening& opening, const FacingWall& wall, const Seen& other) {
            return wall.line == runs_[other.run].line && !looksOver(opening, wall);
        };
        const auto wall =
            std::ranges::find_if(beforeNear, [&](const FacingWall& w) { return hides(near, w, f); });
        if (wall == beforeNear.end() ||
            std::ranges::none_of(beforeFar, [&](const FacingWall& w) { return hides(far, w, n); }))
            return std::nullopt;
        const WallLine &line = lineOf(n), &other = lineOf(f);
        const auto [low, high] =
            std::minmax({line.along(other.at(f.on.from)), line.along(other.at(f.on.to))});
        const Stretch both{std::max({n.on.from, wall->on.from, low}), std::min({n.on.to, wall->on.to, high})};
        const double middle = (both.from + both.to) / 2, there = other.along(line.at(middle));
        const double half = std::min({both.length() / 2, there - f.on.from, f.on.to - there});
        Opening out{near.window,
                    {{n.run, {middle - half, middle + half}}, {f.run, {there - half, there + half}}},
                    far.window};
        if (2 * half < kNarrowest || extentOf(out).length() < kNarrowest) return std::nullopt;
        return out;
    }

    // Of walls side by side, as those of two houses, one has no light from outside where it looks straight at
    // the other: windows opposite one another join the rooms, others are walled up as high as that wall is.
    void lookAtWallsBefore() {
        std::vector<std::vector<FacingWall>> before(openings_.size());
        std::vector<std::vector<Opening>> made(openings_.size());
        std::vector<double> kept(openings_.size(), 0); // inches
        for (size_t i = 0; i < openings_.size(); ++i) {
            const Seen& side = openings_[i].sides[0];
            if (openings_[i].sides.size() == 1)
                before[i] = wallsBefore(plan_, runs_, runs_[side.run], side.on);
            std::erase_if(before[i], [&](const FacingWall& wall) {
                return wall.on.length() < kNarrowest || isLayerOver(side.on, runs_[side.run], wall);
            });
            std::ranges::stable_sort(before[i], std::greater(), &FacingWall::height);
            for (size_t j = 0; j < i; ++j)
                if (const auto both = joined(openings_[j], before[j], openings_[i], before[i])) {
                    made[j].push_back(*both);
                    for (const size_t k : {i, j}) kept[k] += both->sides[0].on.length();
                }
        }
        std::vector<Opening> out;
        for (size_t i = 0; i < openings_.size(); ++i) {
            out.insert(out.end(), made[i].begin(), made[i].end());
            if (before[i].empty()) {
                out.push_back(openings_[i]);
                continue;
            }
            const Seen& side = openings_[i].sides[0];
            const double mayLose =
                kept[i] > 0 ? std::max(kByEye, kMostCut * side.on.length()) : kNarrowest; // without a word
            std::vector<Stretch> dark;
            const auto keep = [&](Stretch on, double hidden) {
                for (const Stretch& rest : without(on, dark, 0)) {
                    out.push_back({openings_[i].window, {{side.run, rest}}, nullptr, hidden});
                    kept[i] += rest.length();
                }
            };
            for (const FacingWall& wall : before[i]) {
                if (looksOver(openings_[i], wall)) keep(wall.on, wall.height);
                dark.push_back(wall.on);
            }
            keep(side.on, 0);
            if (side.on.length() - kept[i] > mayLose)
                out_.notes.push_back(
                    {"WINDOW_BEFORE_WALL",
                     fmt::format("window {} looks straight at the wall {}, without air between, and is "
                                 "walled up there",
                                 openings_[i].window->id, before[i][0].id)});
        }
        openings_ = std::move(out);
    }

    void add(Opening opening) {
        const SideWindow& window = *opening.window;
        double roof = 1e9, top = 0; // of the lower room, of the higher one
        for (const Seen& seen : opening.sides) {
            roof = std::min(roof, ceilingOf(seen));
            top = std::max(top, ceilingOf(seen));
        }
        // A transom in a wall that stands above the roof of the lower room looks out over it.
        if (!opening.opposite && window.kind == WindowKind::transom &&
            roof < std::min(top, wallTop(opening.sides[0]))) {
            std::erase_if(opening.sides, [&](const Seen& seen) { return ceilingOf(seen) < top; });
            opening.hidden = roof;
        }
        const auto [sill, head] = extentOf(opening);
        assert(sill < head); // roofs that a wall rises above are at 8, and it is then 10 high: heads are at 9
        const bool twin = opening.sides.size() == 2;
        const std::string id = window.id + (opening.opposite ? "+" + opening.opposite->id : "");
        if (twin && (window.blind != Blind{} || (opening.opposite && opening.opposite->blind != Blind{})))
            out_.notes.push_back({"BLINDS_INSIDE", fmt::format("window {} is between two rooms, where there "
                                                               "are no blinds: it stands open",
                                                               id)});
        for (const Seen& seen : opening.sides) {
            const WallRun& run = runs_[seen.run];
            const WallLine& line = lineOf(seen);
            const double u = line.along(run.from), v = line.along(run.to);
            const double toRun = u < v ? 1 : -1;
            WindowHole hole;
            hole.run = seen.run;
            hole.from = toRun * ((u < v ? seen.on.from : seen.on.to) - u);
            hole.to = hole.from + (seen.on.to - seen.on.from);
            hole.sill = sill;
            hole.head = head;
            hole.opening = out_.openings;
            hole.twin = twin;
            hole.backed = isBacked(seen);
            hole.id = id;
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
    std::vector<Opening> openings_;
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
