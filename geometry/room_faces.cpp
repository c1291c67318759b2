#include "geometry/room_faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <glm/geometric.hpp>

#include "geometry/plan_overlay.h"
#include "geometry/plan_regions.h"
#include "geometry/wall_face.h"

namespace heliodon::geometry {

namespace {

constexpr double kApart = 0.005;       // inches: nearer divisions of a wall are one
const double kPartitionTop = heightInches(HeightClass::green);

glm::dvec3 inWorld(glm::dvec2 p, double height) {
    return kMetresPerInch * glm::dvec3(p.x, height, -p.y);
}

class RoomFaceBuilder {
public:
    explicit RoomFaceBuilder(const RoomFaceInput& in) : in_(in), holes_(in.holes) {
        out_.floorArea.assign(in.rooms.size(), 0);
        out_.lowArea.assign(in.rooms.size(), 0);
        out_.partitionUsed.assign(in.plan.partitions.size(), false);
        out_.skylightUsed.assign(in.skylights.size(), false);
    }

    RoomFaces build() {
        buildFloors();
        buildCeilings();
        divideRuns();
        for (size_t r = 0; r < in_.runs.size(); ++r) buildRun(r);
        return std::move(out_);
    }

private:
    // Polygons of the region at one height; `up` says whether the air is above.
    SoupFace& addFlat(const PlanArrangement& map, const PlanRegion& region, double height, bool up) {
        SoupFace face;
        for (const auto& halves : region.loops) {
            std::vector<glm::dvec3> loop;
            for (const uint32_t h : halves) loop.push_back(inWorld(map.points[map.source(h)], height));
            if (!up) std::ranges::reverse(loop);
            face.loops.push_back(std::move(loop));
        }
        out_.faces.push_back(std::move(face));
        return out_.faces.back();
    }

    void buildFloors() {
        std::vector<std::vector<glm::dvec2>> shapes;
        for (const WallPiece& piece : in_.plan.partitions) {
            const PlanSolid solid = footprint(piece);
            shapes.push_back(solid.outline);
            sides_.push_back(solid.sides);
        }
        floor_ = overlay(in_.rooms, shapes, Touching::joined);
        const PlanArrangement& map = floor_.map;
        labels_ = floor_.label;
        const std::vector<double> areas = cellAreas(map);
        for (uint32_t c = 0; c < map.cellCount; ++c) {
            if (labels_[c] < 0) continue;
            (labels_[c] % 2 ? out_.lowArea : out_.floorArea)[static_cast<size_t>(labels_[c] / 2)] += areas[c];
            if (labels_[c] % 2 && floor_.shape[c] >= 0)
                out_.partitionUsed[static_cast<size_t>(floor_.shape[c])] = true;
        }
        const uint32_t firstSurface = nextSurface_;
        nextSurface_ += static_cast<uint32_t>(in_.rooms.size());
        for (const PlanRegion& region : traceRegions(map, labels_)) {
            const auto room = static_cast<uint32_t>(region.label / 2);
            const bool low = region.label % 2;
            SoupFace& face = addFlat(map, region, low ? kPartitionTop : 0, true);
            face.room = room;
            face.surface = low ? nextSurface_++ : firstSurface + room;
            face.material = low ? materialOfTop(region) : in_.materials[room].floor;
            if (low) buildPartitionSides(region);
        }
    }

    uint32_t materialOfTop(const PlanRegion& region) const {
        const int shape = floor_.shape[floor_.map.cell[region.loops[0][0]]];
        return in_.partitionMaterial[static_cast<size_t>(std::max(shape, 0))];
    }

    // Where the region borders the same room's floor; the air is on the right.
    void buildPartitionSides(const PlanRegion& region) {
        const PlanArrangement& map = floor_.map;
        std::map<std::pair<size_t, size_t>, uint32_t> surfaces;
        for (const auto& loop : region.loops)
            for (const uint32_t h : loop) {
                if (labels_[map.cell[h ^ 1u]] != region.label - 1) continue;
                std::pair<size_t, size_t> side{in_.plan.partitions.size(), h};
                for (const PlanArrangement::Tag& tag : map.tags[h / 2])
                    if (const auto k = static_cast<size_t>(tag.tag - floor_.outlineTags);
                        tag.tag >= floor_.outlineTags && k < floor_.shapeEdge.size())
                        side = floor_.shapeEdge[k];
                uint32_t material = materialOfTop(region);
                if (side.first < in_.plan.partitions.size()) {
                    material = in_.partitionMaterial[side.first];
                    // Facets of one curved side are one surface.
                    if (in_.plan.partitions[side.first].curved)
                        side.second = 1000 + static_cast<size_t>(sides_[side.first][side.second]);
                }
                const auto [place, isNew] = surfaces.try_emplace(side, nextSurface_);
                if (isNew) ++nextSurface_;
                const glm::dvec2 p = map.points[map.source(h)], q = map.points[map.target[h]];
                SoupFace face;
                face.loops = {
                    {inWorld(p, 0), inWorld(q, 0), inWorld(q, kPartitionTop), inWorld(p, kPartitionTop)}};
                face.room = static_cast<uint32_t>(region.label / 2);
                face.surface = place->second;
                face.material = material;
                out_.faces.push_back(std::move(face));
            }
    }

    std::vector<std::vector<glm::dvec2>> skylightOutlines() const {
        std::vector<std::vector<glm::dvec2>> outlines;
        for (const Skylight& sky : in_.skylights) {
            const double angle = sky.angleDeg * std::numbers::pi / 180;
            const glm::dvec2 u = 0.5 * sky.size.x * glm::dvec2(std::cos(angle), std::sin(angle));
            const glm::dvec2 v = 0.5 * sky.size.y * glm::dvec2(-std::sin(angle), std::cos(angle));
            outlines.push_back(
                {sky.center - u - v, sky.center + u - v, sky.center + u + v, sky.center - u + v});
        }
        return outlines;
    }

    void buildCeilings() {
        const PlanOverlay over = overlay(in_.rooms, skylightOutlines(), Touching::parted);
        const PlanArrangement& map = over.map;
        std::vector<int> labels = over.label;
        dropSmallPanes(map, labels);
        const uint32_t firstSurface = nextSurface_;
        nextSurface_ += static_cast<uint32_t>(in_.rooms.size());
        for (uint32_t c = 0; c < map.cellCount; ++c)
            if (labels[c] >= 0 && labels[c] % 2 && over.shape[c] >= 0)
                out_.skylightUsed[static_cast<size_t>(over.shape[c])] = true;
        std::vector<std::set<int>> panes; // by the skylights that each is made of
        for (const PlanRegion& region : traceRegions(map, labels)) {
            const auto room = static_cast<uint32_t>(region.label / 2);
            const bool pane = region.label % 2;
            SoupFace& face = addFlat(map, region, in_.ceilings[room], false);
            face.room = room;
            face.role = Role::fillIn;
            face.surface = pane ? nextSurface_++ : firstSurface + room;
            face.material = in_.materials[room].ceiling;
            if (!pane) continue;
            std::set<int> skylights = skylightsOf(map, over, region, room);
            if (!skylights.empty())
                face.material =
                    in_.skylightMaterial[static_cast<size_t>(*skylights.begin()) % in_.skylights.size()];
            addPane(panes, std::move(skylights));
        }
        out_.skylightPanes = static_cast<int>(panes.size());
    }

    // One number a skylight and room.
    std::set<int> skylightsOf(const PlanArrangement& map, const PlanOverlay& over, const PlanRegion& region,
                              uint32_t room) const {
        std::set<int> out;
        for (const auto& loop : region.loops)
            for (const uint32_t h : loop)
                if (const int sky = over.shape[map.cell[h]]; sky >= 0)
                    out.insert(sky + static_cast<int>(room * in_.skylights.size()));
        return out;
    }

    // Glass of one skylight in one room is one pane, even where a wall that reaches the ceiling parts it.
    static void addPane(std::vector<std::set<int>>& panes, std::set<int> skylights) {
        for (size_t i = panes.size(); i-- > 0;)
            if (std::ranges::any_of(skylights, [&](int sky) { return panes[i].contains(sky); })) {
                skylights.merge(panes[i]);
                panes.erase(panes.begin() + static_cast<std::ptrdiff_t>(i));
            }
        panes.push_back(std::move(skylights));
    }

    static void dropSmallPanes(const PlanArrangement& map, std::vector<int>& labels) {
        const std::vector<double> areas = cellAreas(map);
        for (const PlanRegion& region : traceRegions(map, labels)) {
            if (region.label % 2 == 0) continue;
            double area = 0;
            std::set<uint32_t> cells;
            for (const auto& loop : region.loops)
                for (const uint32_t h : loop) {
                    const glm::dvec2 a = map.points[map.source(h)], b = map.points[map.target[h]];
                    area += 0.5 * (a.x * b.y - a.y * b.x);
                    cells.insert(map.cell[h]);
                }
            if (area < kSmallestPane)
                for (const uint32_t c : cells) labels[c] = region.label - 1;
        }
    }

    struct Break {
        double at; // inches along the run
        glm::dvec2 point;
        // Of the outline, within the run: floor and ceiling turn there, if by next to nothing.
        bool corner = false;
    };
    struct RunGrid {
        std::vector<Break> columns;
        std::vector<double> rows;
        std::vector<std::pair<double, double>> low; // stretches where a partition stands against the wall
    };

    double along(const WallRun& run, glm::dvec2 p) const {
        return glm::dot(p - run.from, glm::normalize(run.to - run.from));
    }

    static void addBreak(std::vector<Break>& breaks, Break added) {
        for (const Break& b : breaks)
            if (std::abs(b.at - added.at) < kApart) return;
        breaks.push_back(added);
    }

    static void addRow(std::vector<double>& rows, double row) {
        for (const double r : rows)
            if (std::abs(r - row) < kApart) return;
        rows.push_back(row);
    }

    const OutlineLoop& loopOf(const WallRun& run) const { return in_.rooms[run.room].loops[run.loop]; }

    void divideRuns() {
        std::map<int32_t, size_t> runOfTag;
        int32_t tag = 0;
        std::map<std::tuple<size_t, size_t, size_t>, size_t> runOfEdge;
        for (size_t r = 0; r < in_.runs.size(); ++r)
            for (size_t k = 0; k < in_.runs[r].count; ++k) {
                const WallRun& run = in_.runs[r];
                runOfEdge[{run.room, run.loop, (run.first + k) % loopOf(run).points.size()}] = r;
            }
        for (size_t room = 0; room < in_.rooms.size(); ++room)
            for (size_t l = 0; l < in_.rooms[room].loops.size(); ++l)
                for (size_t k = 0; k < in_.rooms[room].loops[l].points.size(); ++k)
                    runOfTag[tag++] = runOfEdge.at({room, l, k});

        grids_.resize(in_.runs.size());
        for (size_t r = 0; r < in_.runs.size(); ++r) divideRun(r);
        markPartitions(runOfTag);
        for (WindowHole& hole : holes_) snapEnds(hole);
        for (const WindowHole& hole : holes_) divideAtHole(hole);
        shareTwinBreaks();
        for (RunGrid& grid : grids_) {
            std::ranges::sort(grid.columns, {}, &Break::at);
            std::ranges::sort(grid.rows);
        }
    }

    void divideRun(size_t r) {
        const WallRun& run = in_.runs[r];
        const OutlineLoop& loop = loopOf(run);
        RunGrid& grid = grids_[r];
        const double ceiling = in_.ceilings[run.room];
        grid.rows = {0, ceiling};
        for (size_t k = 0; k <= run.count; ++k) {
            const glm::dvec2 p = loop.points[(run.first + k) % loop.points.size()];
            addBreak(grid.columns, {along(run, p), p, k > 0 && k < run.count});
            const double height = loop.edges[(run.first + k) % loop.points.size()].height;
            if (k < run.count && height > 0 && height < ceiling) addRow(grid.rows, height);
        }
    }

    void markPartitions(const std::map<int32_t, size_t>& runOfTag) {
        const PlanArrangement& map = floor_.map;
        for (uint32_t h = 0; h < map.cell.size(); ++h) {
            const int own = labels_[map.cell[h]], other = labels_[map.cell[h ^ 1u]];
            if (own < 0 || own % 2 == 0 || (other >= 0 && other / 2 == own / 2)) continue;
            for (const PlanArrangement::Tag& tag : map.tags[h / 2]) {
                if (tag.tag >= floor_.outlineTags || tag.forward != (h % 2 == 0)) continue;
                const size_t r = runOfTag.at(tag.tag);
                const glm::dvec2 p = map.points[map.source(h)], q = map.points[map.target[h]];
                RunGrid& grid = grids_[r];
                addBreak(grid.columns, {along(in_.runs[r], p), p});
                addBreak(grid.columns, {along(in_.runs[r], q), q});
                addRow(grid.rows, kPartitionTop);
                grid.low.emplace_back(along(in_.runs[r], p), along(in_.runs[r], q));
            }
        }
    }

    // A partition against the wall raises the sill of windows over it, on both sides alike.
    double sillOf(const WindowHole& hole) const {
        double sill = hole.sill;
        for (const WindowHole& side : holes_)
            if (side.opening == hole.opening)
                for (const auto& [from, to] : grids_[side.run].low)
                    if (from < side.to && to > side.from) sill = std::max(sill, kPartitionTop);
        return sill;
    }

    // To divisions that the wall has there without it, on both sides of it alike.
    void snapEnds(WindowHole& hole) {
        for (double WindowHole::*const end : {&WindowHole::from, &WindowHole::to})
            for (const Break& b : grids_[hole.run].columns) {
                const double move = b.at - hole.*end;
                if (std::abs(move) >= kApart) continue;
                hole.*end = b.at;
                for (WindowHole& other : holes_)
                    if (&other != &hole && other.opening == hole.opening)
                        (end == &WindowHole::from ? other.to : other.from) -= move;
                break;
            }
    }

    void divideAtHole(const WindowHole& hole) {
        const WallRun& run = in_.runs[hole.run];
        RunGrid& grid = grids_[hole.run];
        const glm::dvec2 d = glm::normalize(run.to - run.from);
        for (const double at : {hole.from, hole.to}) addBreak(grid.columns, {at, run.from + at * d});
        addRow(grid.rows, sillOf(hole));
        addRow(grid.rows, hole.head);
    }

    // The two glasses of an interior window have equal corners on their borders, so that their meshes mirror.
    // A wall may have windows into several rooms, so that breaks travel on until no grid gets a new one.
    void shareTwinBreaks() {
        constexpr int kMostRounds = 16;
        bool any = true;
        for (int round = 0; any && round < kMostRounds; ++round) {
            any = false;
            for (const WindowHole& a : holes_)
                for (const WindowHole& b : holes_)
                    if (&a != &b && a.opening == b.opening) any |= shareBreaks(a, b);
        }
    }

    // True when the grid of `to` got a new one.
    bool shareBreaks(const WindowHole& from, const WindowHole& to) {
        const WallRun& run = in_.runs[to.run];
        RunGrid& grid = grids_[to.run];
        const size_t before = grid.columns.size() + grid.rows.size();
        const glm::dvec2 d = glm::normalize(run.to - run.from);
        const std::vector<Break> columns = grids_[from.run].columns;
        for (const Break& b : columns)
            if (b.at > from.from + kApart && b.at < from.to - kApart) {
                const double at =
                    to.to - (b.at - from.from); // runs on either side of a wall run against one another
                addBreak(grid.columns, {at, run.from + at * d});
            }
        const std::vector<double> rows = grids_[from.run].rows;
        for (const double row : rows)
            if (row > sillOf(from) && row < from.head) addRow(grid.rows, row);
        return grid.columns.size() + grid.rows.size() > before;
    }

    // Labels of a grid: 0 wall that stands there, 1 fill-in, 2 + k the k-th hole of this run.
    void buildRun(size_t r) {
        const WallRun& run = in_.runs[r];
        const RunGrid& grid = grids_[r];
        const auto columns = static_cast<uint32_t>(grid.columns.size() - 1),
                   rows = static_cast<uint32_t>(grid.rows.size() - 1);
        std::vector<size_t> holes;
        for (size_t k = 0; k < holes_.size(); ++k)
            if (holes_[k].run == r) holes.push_back(k);
        std::vector<int> labels(size_t{columns} * rows);
        std::vector<bool> keep(size_t{columns + 1} * (rows + 1), false);
        for (uint32_t row = 0; row < rows; ++row)
            for (uint32_t column = 0; column < columns; ++column) {
                const int label = labelOf(run, grid, holes, column, row);
                labels[size_t{row} * columns + column] = label;
                if (label >= 2 && holes_[holes[static_cast<size_t>(label - 2)]].twin)
                    for (const size_t at :
                         {size_t{row} * (columns + 1) + column, size_t{row + 1} * (columns + 1) + column})
                        keep[at] = keep[at + 1] = true;
            }
        for (uint32_t column = 0; column <= columns; ++column)
            for (uint32_t row = 0; grid.columns[column].corner && row <= rows; ++row)
                keep[size_t{row} * (columns + 1) + column] = true;
        const uint32_t wallSurface = surfaceOfRun(r);
        std::map<int, uint32_t> glassSurface;
        for (const GridFace& gridFace : gridFaces(columns, rows, labels, keep)) {
            SoupFace face;
            for (const auto& gridLoop : gridFace.loops) {
                std::vector<glm::dvec3> loop;
                for (const GridPoint p : gridLoop)
                    loop.push_back(inWorld(grid.columns[p.column].point, grid.rows[p.row]));
                std::ranges::reverse(loop); // columns run to the left as seen from the air
                face.loops.push_back(std::move(loop));
            }
            face.room = static_cast<uint32_t>(run.room);
            face.material = in_.runMaterial[r];
            face.surface = wallSurface;
            face.role = gridFace.label == 1 ? Role::fillIn : Role::projection;
            if (gridFace.label >= 2) {
                const size_t number = holes[static_cast<size_t>(gridFace.label - 2)];
                const WindowHole& hole = holes_[number];
                face.material = in_.holeMaterial[number];
                face.role = hole.backed ? Role::projection : Role::fillIn;
                if (hole.twin) face.twinKey = hole.opening;
                const auto [place, isNew] = glassSurface.try_emplace(gridFace.label, nextSurface_);
                if (isNew) ++nextSurface_;
                face.surface = place->second;
            }
            out_.faces.push_back(std::move(face));
        }
    }

    int labelOf(const WallRun& run, const RunGrid& grid, const std::vector<size_t>& holes, uint32_t column,
                uint32_t row) const {
        const double s = 0.5 * (grid.columns[column].at + grid.columns[column + 1].at);
        const double h = 0.5 * (grid.rows[row] + grid.rows[row + 1]);
        for (const auto& [from, to] : grid.low)
            if (s > from && s < to && h < kPartitionTop) return -1;
        for (size_t k = 0; k < holes.size(); ++k) {
            const WindowHole& hole = holes_[holes[k]];
            if (s > hole.from && s < hole.to && h > sillOf(hole) && h < hole.head)
                return 2 + static_cast<int>(k);
        }
        const OutlineLoop& loop = loopOf(run);
        double wallTop = 0;
        for (size_t k = 0; k < run.count; ++k) {
            const size_t n = loop.points.size(), i = (run.first + k) % n;
            if (s > along(run, loop.points[i]) && s < along(run, loop.points[(i + 1) % n]))
                wallTop = loop.edges[i].height;
        }
        return h < wallTop ? 0 : 1;
    }

    // Neighbouring facets of one arc are one surface.
    uint32_t surfaceOfRun(size_t r) {
        const WallRun& run = in_.runs[r];
        if (run.curved < 0) return nextSurface_++;
        const auto [place, isNew] =
            arcSurface_.try_emplace({run.room, run.loop, run.curved, arcSide(run)}, nextSurface_);
        if (isNew) ++nextSurface_;
        return place->second;
    }

    // An arc's concave, convex or end face.
    int arcSide(const WallRun& run) const {
        const WallPiece& piece = in_.plan.pieces[static_cast<size_t>(run.curved)];
        const double r0 = glm::length(run.from - piece.center), r1 = glm::length(run.to - piece.center);
        if (std::abs(r0 - r1) > piece.thickness / 2) return 2;
        return r0 + r1 > 2 * piece.radius;
    }

    const RoomFaceInput& in_;
    std::vector<WindowHole> holes_; // with ends on divisions of the wall that are near
    RoomFaces out_;
    PlanOverlay floor_;
    std::vector<int> labels_;
    std::vector<std::vector<SolidSide>> sides_;
    std::vector<RunGrid> grids_;
    std::map<std::tuple<size_t, size_t, int, int>, uint32_t> arcSurface_;
    uint32_t nextSurface_ = 0;
};

} // namespace

RoomFaces roomFaces(const RoomFaceInput& input) {
    return RoomFaceBuilder(input).build();
}

} // namespace heliodon::geometry
