#include "compute/point_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "compute/lighting.h"
#include "compute/outside_walls.h"
#include "compute/view_cells.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

// Of what stands outside, as each may hide what another before the same window sends: a hundred and seventy
// leaves send a hundredth of a room's light, and would take ten times as long as without.
constexpr double kMostPairs = 30'000;

// What of a convex polygon lies more than `least` behind a plane.
void behind(std::span<const dvec3> polygon, dvec3 origin, dvec3 normal, double least,
            PointView::Polygon& result) {
    geometry::clip<dvec3>(
        polygon, [&](const dvec3& p) { return glm::dot(origin - p, normal) - least; }, result);
}

// The patches of one room that the point is in front of: work(patch, corners, away).
template<class Work>
void forPatchesOf(const PointScene& scene, const PointView& view, uint32_t room, const Work& work) {
    const geometry::PatchMesh& mesh = scene.mesh();
    const double least = scene.blockers().tolerance();
    for (size_t j = 0; j < mesh.patchCount(); ++j) {
        const PointScene::Patch& patch = scene.patches()[j];
        if (mesh.room[j] != room) continue;
        if (mesh.twin[j] != geometry::kNoTwin && isClear(mesh.materials[mesh.material[j]])) continue;
        const dvec3 away = patch.centre - view.position();
        if (-glm::dot(away, patch.normal) <= least) continue; // seen from behind, or edge-on
        if (!view.mayShow(patch.centre, patch.radius)) continue;
        work(j, geometry::patchCorners(mesh, j), away);
    }
}

// One sensor's two rows, as far as they are about patches of its own room.
void makeRows(const PointScene& scene, const PatchSlopes& slopes, const PointView& view, uint32_t room,
              const SlopeDetail& detail, float* even, float* smooth) {
    std::vector<PointView::Polygon> parts;
    forPatchesOf(scene, view, room, [&](size_t j, std::span<const dvec3> corners, dvec3 away) {
        const auto terms = slopes.terms(j);
        if (terms.empty() || scene.patches()[j].size < detail.farSize * glm::length(away)) {
            const auto factor = static_cast<float>(view.factor(corners));
            even[j] += factor, smooth[j] += factor;
            return;
        }
        const double factor = view.factor(corners, parts);
        if (factor <= 0) return;
        even[j] += static_cast<float>(factor);
        smooth[j] += static_cast<float>(factor);
        dvec3 moment(0);
        double weights = 0;
        for (const PointView::Polygon& part : parts)
            forCells(part, view.normal(), detail.angle, [&](dvec3 centre, double weight) {
                moment += weight * (centre - away);
                weights += weight;
            });
        if (weights <= 0) return;
        moment *= factor / weights;
        for (const PatchSlopes::Term& term : terms)
            smooth[term.patch] += static_cast<float>(glm::dot(moment, dvec3(term.weight)));
    });
}

// Of a room behind glass: from afar, no slope.
void makeRowBeyond(const PointScene& scene, const PointView& view, const RoomBeyond& beyond,
                   std::initializer_list<float*> rows, std::vector<TintedShare>& tinted) {
    std::vector<PointView::Polygon> parts;
    forPatchesOf(scene, view, beyond.room, [&](size_t j, std::span<const dvec3> corners, dvec3) {
        const double factor = view.factor(corners, parts);
        if (factor <= 0) return;
        dvec3 middle(0);
        for (const PointView::Polygon& part : parts)
            for (const dvec3& corner : part) middle += glm::normalize(corner) / double(part.size());
        const glm::vec3 through(beyond.transmittance(middle));
        const auto mean = static_cast<float>(photometric(through)), share = static_cast<float>(factor) * mean;
        for (float* row : rows) row[j] += share;
        if (through.x != through.y || through.y != through.z)
            tinted.push_back({static_cast<uint32_t>(j), static_cast<float>(factor) * (through - mean)});
    });
}

} // namespace

dvec3 RoomBeyond::transmittance(dvec3 direction) const {
    dvec3 through(1);
    const dvec3 towards = glm::normalize(direction);
    for (const Pane& pane : panes)
        through *= pane.window->straight(pane.entered ? -towards : towards, pane.normal);
    return through;
}

PointScene::PointScene(const geometry::PatchMesh& mesh) : mesh_(&mesh), blockers_(mesh) {
    const size_t n = mesh.patchCount();
    std::vector<uint32_t> opening(n, kNoGroup), pane(n, kNoGroup), wall(n, kNoGroup);
    std::map<std::array<uint32_t, 2>, uint32_t> links; // material, room beyond
    for (size_t i = 0; i < n; ++i) {
        Patch patch{geometry::patchCentroid(mesh, i), geometry::patchNormal(mesh, i),
                    std::sqrt(geometry::patchArea(mesh, i)), 0};
        for (const uint32_t v : mesh.patch(i))
            patch.radius = std::max(patch.radius, glm::length(mesh.vertices[v] - patch.centre));
        patches_.push_back(patch);
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        if (!material.isOpening())
            wall[i] = 0;
        else if (mesh.twin[i] == geometry::kNoTwin)
            opening[i] = mesh.material[i];
        else if (isClear(material))
            pane[i] = links
                          .try_emplace({mesh.material[i], mesh.room[static_cast<size_t>(mesh.twin[i])]},
                                       links.size())
                          .first->second;
    }
    for (const geometry::Material& material : mesh.materials) windows_.emplace_back(material);
    std::vector<std::array<uint32_t, 2>> linkOf(links.size());
    for (const auto& [link, id] : links) linkOf[id] = link;
    for (ConvexRegion& region : mergedRegions(mesh, pane, 16)) {
        const auto& [material, room] = linkOf[region.group];
        const dvec3 normal = normalOf(region);
        panes_.push_back({std::move(region), &windows_[material], normal, room});
    }
    const std::vector<ConvexRegion> openings = mergedRegions(mesh, opening, 16);
    const std::vector<ConvexRegion> walls = mergedRegions(mesh, wall, 16);
    outside_ = OutsideCells(mesh, openings, walls);
    findOpenings(openings, walls);
    blackenCrowds(openings);
}

void PointScene::findOpenings(const std::vector<ConvexRegion>& openings,
                              const std::vector<ConvexRegion>& walls) {
    const double samePlane = kSamePlane * geometry::boundsOf(mesh_->vertices).diagonal();
    for (const ConvexRegion& region : openings) openings_.push_back({region, normalOf(region), {}, {}, {}});
    const auto outsideOf = [&](const Opening& opening, std::span<const dvec3> corners) {
        PointView::Polygon part;
        behind(corners, opening.region.corners[0], opening.normal, samePlane, part);
        return part.size() < 3 ? PointView::Polygon{} : part;
    };
    for (Opening& from : openings_) {
        for (const ConvexRegion& wall : walls)
            if (auto part = outsideOf(from, wall.corners); !part.empty()) from.hiddenBy.push_back(part);
        std::vector<const ConvexRegion*> seen = seenFrom(from.region, outside_.regions(), samePlane);
        const auto regionOf = [&](const ConvexRegion* wall) {
            return static_cast<size_t>(wall - outside_.regions().data());
        };
        for (const ConvexRegion* wall : seen) {
            auto part = outsideOf(from, wall->corners);
            if (part.empty()) continue;
            const size_t region = regionOf(wall);
            if (!outside_.isOfRooms(region)) from.hiddenBy.push_back(part); // the others hide as walls
            if (outside_.reflects(region)) from.walls.push_back({region, std::move(part)});
        }
        std::erase_if(seen, [&](const ConvexRegion* wall) { return outside_.isOfRooms(regionOf(wall)); });
        for (uint32_t k = 0; k < openings_.size(); ++k) {
            const Opening& to = openings_[k];
            auto part = &to == &from ? PointView::Polygon{} : outsideOf(from, to.region.corners);
            if (part.empty()) continue;
            from.hiddenBy.push_back(std::move(part)); // the sky; what is seen through both is not the sky
            if (outsideOf(to, from.region.corners).empty() || !window(from).passesStraight() ||
                !window(to).passesStraight())
                continue;
            Facing facing{k, {}};
            const geometry::Bounds one = geometry::boundsOf(from.region.corners),
                                   two = geometry::boundsOf(to.region.corners);
            const dvec3 low = glm::min(one.low, two.low) - samePlane,
                        high = glm::max(one.high, two.high) + samePlane;
            const auto between = [&](std::span<const dvec3> corners) {
                const geometry::Bounds box = geometry::boundsOf(corners);
                if (glm::any(glm::lessThan(box.high, low)) || glm::any(glm::greaterThan(box.low, high)))
                    return;
                if (auto here = outsideOf(from, corners); !here.empty())
                    if (here = outsideOf(to, here); !here.empty()) facing.hiddenBy.push_back(std::move(here));
            };
            for (const ConvexRegion& wall : walls) between(wall.corners);
            for (const ConvexRegion* wall : seen) between(wall->corners);
            for (const Opening& other : openings_)
                if (&other != &from && &other != &to) between(other.region.corners);
            from.facing.push_back(std::move(facing));
        }
        seesOthers_ |= !from.facing.empty();
    }
}

void PointScene::blackenCrowds(const std::vector<ConvexRegion>& openings) {
    double pairs = 0;
    for (const Opening& opening : openings_) {
        const auto standing = static_cast<double>(std::ranges::count_if(
            opening.walls, [&](const Opening::Wall& wall) { return !outside_.isOfRooms(wall.region); }));
        pairs += standing * standing;
    }
    if (pairs <= kMostPairs) return;
    outside_.blackenStanding(*mesh_, openings);
    for (Opening& opening : openings_)
        std::erase_if(opening.walls,
                      [&](const Opening::Wall& wall) { return !outside_.reflects(wall.region); });
}

std::vector<PointView> PointScene::framesOf(const PointView& view,
                                            std::span<const PointView::Polygon> parts) const {
    std::vector<PointView> frames;
    for (const PointView::Polygon& part : parts)
        frames.push_back(view.through(blockers_, part, geometry::kNoRoom));
    return frames;
}

// Of a facade of many windows one shows little from one point: a quick look before polygons are cut.
bool PointScene::anyShows(std::span<const PointView> frames, std::span<const dvec3> polygon) {
    return std::any_of(frames.begin(), frames.end(),
                       [&](const PointView& frame) { return frame.mayShow(polygon); });
}

void PointScene::forRoomsSeen(const PointView& view, const RoomBeyond& here, const RoomWork& work) const {
    constexpr size_t kMostPanes = 4;
    work(view, here);
    if (here.panes.size() >= kMostPanes) return;
    std::vector<PointView::Polygon> parts, far;
    const auto inFrontOf = [&](const ConvexRegion& region, dvec3 normal) {
        return region.room == here.room &&
               glm::dot(view.position() - region.corners[0], normal) > blockers_.tolerance() &&
               view.factor(region.corners, parts) > 0;
    };
    // On through `part` of one pane, whose frame it is, and the next one, which leads to the room. What is
    // seen through that part is made where it may show something.
    const auto goOn = [&](const PointView::Polygon& part, const PointView& frame,
                          std::optional<PointView>& glimpse, const ConvexRegion& second,
                          const RoomBeyond& next) {
        if (!frame.mayShow(second.corners)) return;
        if (!glimpse) glimpse = view.through(blockers_, part, next.room);
        if (glimpse->factor(second.corners, far) <= 0) return;
        for (const PointView::Polygon& inner : std::vector(far))
            forRoomsSeen(view.through(blockers_, inner, next.room), next, work);
    };
    for (const Pane& pane : panes_) {
        if (!inFrontOf(pane.region, pane.normal)) continue;
        RoomBeyond next{pane.roomBeyond, here.panes};
        next.panes.push_back({pane.window, pane.normal, false});
        for (const PointView::Polygon& part : parts) {
            const PointView frame = view.through(blockers_, part, geometry::kNoRoom);
            std::optional<PointView> glimpse;
            for (const Pane& twin : panes_) // the glass in the wall's other face bounds what is seen too
                if (twin.region.room == pane.roomBeyond && twin.roomBeyond == here.room &&
                    glm::dot(twin.normal, pane.normal) <= -0.999)
                    goOn(part, frame, glimpse, twin.region, next);
        }
    }
    if (here.panes.size() + 2 > kMostPanes) return;
    for (const Opening& from : openings_) {
        if (from.facing.empty() || !inFrontOf(from.region, from.normal)) continue;
        const std::vector<PointView> framed = framesOf(view, parts);
        for (const Facing& facing : from.facing) {
            const Opening& to = openings_[facing.to];
            if (!anyShows(framed, to.region.corners)) continue;
            std::vector<PointView::Polygon> open = parts;
            std::vector<const PointView::Polygon*> hiding;
            for (const PointView::Polygon& wall : facing.hiddenBy) hiding.push_back(&wall);
            view.hideBeyond(hiding, open);
            RoomBeyond next{to.region.room, here.panes};
            next.panes.push_back({&window(from), from.normal, false});
            next.panes.push_back({&window(to), to.normal, true});
            for (const PointView::Polygon& part : open) {
                std::optional<PointView> glimpse;
                goOn(part, view.through(blockers_, part, geometry::kNoRoom), glimpse, to.region, next);
            }
        }
    }
}

double PointScene::factor(const PointView& view, uint32_t patch) const {
    const Patch& at = patches_[patch];
    if (glm::dot(view.position() - at.centre, at.normal) <= blockers_.tolerance()) return 0;
    return view.factor(geometry::patchCorners(*mesh_, patch));
}

void PointScene::seePatches(const PointView& view, uint32_t room, const PatchSlopes& slopes, float* even,
                            float* smooth, std::vector<TintedShare>& tinted,
                            const SlopeDetail& detail) const {
    forRoomsSeen(view, {room, {}}, [&](const PointView& seen, const RoomBeyond& beyond) {
        if (beyond.panes.empty())
            makeRows(*this, slopes, seen, room, detail, even, smooth);
        else
            makeRowBeyond(*this, seen, beyond, {even, smooth}, tinted);
    });
}

void PointScene::seePatchesBeyond(const PointView& view, uint32_t room, float* row,
                                  std::vector<TintedShare>& tinted) const {
    forRoomsSeen(view, {room, {}}, [&](const PointView& seen, const RoomBeyond& beyond) {
        if (!beyond.panes.empty()) makeRowBeyond(*this, seen, beyond, {row}, tinted);
    });
}

dvec3 PointScene::GlassBefore::transmittance(dvec3 direction) const {
    const daylight::Glazing& glazing = window->glazing();
    const dvec3 through =
        grey ? dvec3(daylight::slabTransmittance(-glm::dot(direction, normal), glazing.transmissivity.x,
                                                 glazing.refractiveIndex))
             : window->straight(direction, normal);
    return beyond->panes.empty() ? through : through * beyond->transmittance(direction);
}

Blockers PointScene::blockersOfSky(uint32_t patch) const {
    if (hasRoomsBeyond()) return blockers_;
    std::vector<dvec3> ends = geometry::patchCorners(*mesh_, patch);
    for (const Opening& opening : openings_)
        if (opening.region.room == mesh_->room[patch])
            ends.insert(ends.end(), opening.region.corners.begin(), opening.region.corners.end());
    return blockers_.between(ends);
}

void PointScene::forOutside(const PointView& view, uint32_t room, const OutsideWork& work,
                            const OutsideWallWork& byWall) const {
    forRoomsSeen(view, {room, {}}, [&](const PointView& seen, const RoomBeyond& beyond) {
        outsideOf(seen, beyond, work, byWall);
    });
}

void PointScene::forOutsideThrough(const PointView& view, const PointView::Hiding& hiding,
                                   const OutsideWork& work) const {
    std::vector<PointView::Polygon> parts;
    for (const Opening& opening : openings_) {
        const dvec3 away = view.position() - opening.region.corners[0];
        if (!window(opening).passesStraight() || glm::dot(away, opening.normal) >= -blockers_.tolerance() ||
            view.factor(opening.region.corners, parts) <= 0)
            continue;
        view.hideBehind(hiding, parts);
        const RoomBeyond within{opening.region.room, {{&window(opening), opening.normal, true}}};
        for (const PointView::Polygon& part : parts)
            forRoomsSeen(
                view.through(blockers_, part, within.room), within,
                [&](const PointView& seen, const RoomBeyond& beyond) { outsideOf(seen, beyond, work, {}); });
    }
}

void PointScene::outsideOf(const PointView& view, const RoomBeyond& beyond, const OutsideWork& work,
                           const OutsideWallWork& byWall) const {
    std::vector<PointView::Polygon> parts;
    for (const Opening& opening : openings_) {
        const daylight::Window& pane = window(opening);
        if (opening.region.room != beyond.room || !pane.passesStraight()) continue;
        if (glm::dot(view.position() - opening.region.corners[0], opening.normal) <= blockers_.tolerance())
            continue;
        if (view.factor(opening.region.corners, parts) <= 0) continue;
        const std::vector<PointView> framed = framesOf(view, parts);
        std::vector<const PointView::Polygon*> hiding;
        for (const PointView::Polygon& wall : opening.hiddenBy)
            if (anyShows(framed, wall)) hiding.push_back(&wall);
        view.hideBeyond(hiding, parts);
        const glm::dvec3 t = pane.glazing().transmissivity;
        const bool grey = t.x == t.y && t.y == t.z && !pane.glazing().isHole() && !pane.hasBlind();
        const GlassBefore glass{&pane, opening.normal, &beyond, grey};
        for (const PointView::Polygon& part : parts) work(part, glass);
        if (!byWall) continue;
        std::optional<PointView::Hiding> before;
        for (const auto& [region, wall] : opening.walls) {
            if (!isBefore(view.position(), region)) continue;
            for (const PointView& frame : framed) {
                if (!frame.mayShow(wall) || frame.factor(wall, parts) <= 0) continue;
                if (!before) before = view.hidingBehind(hiding);
                view.hideBehind(*before, parts);
                for (const PointView::Polygon& part : parts) byWall(part, region, glass);
            }
        }
    }
}

bool PointScene::mayShowLow(dvec3 position, dvec3 normal, uint32_t room, double slope) const {
    if (hasRoomsBeyond()) return true;
    // What lies above a cone round the upright axis is convex, and so is what lies behind the point.
    return std::ranges::any_of(openings_, [&](const Opening& opening) {
        if (opening.region.room != room) return false;
        bool above = true, below = true, behind = true;
        for (const dvec3& corner : opening.region.corners) {
            const dvec3 p = corner - position;
            above &= p.y > slope * std::hypot(p.x, p.z);
            below &= p.y <= 0;
            behind &= glm::dot(p, normal) <= 0;
        }
        return !above && !below && !behind;
    });
}

void PointScene::seeWall(const PointView& view, const PointView::Polygon& part, size_t region,
                         const GlassBefore& glass, double angle, std::vector<OutsideShare>& walls) const {
    forSamples(view, part, angle, [&](dvec3 centre, double factor) {
        walls.push_back({outside_.cellAt(region, view.position() + centre),
                         glm::vec3(factor * glass.transmittance(glm::normalize(centre)))});
    });
}

void PointScene::seeSky(const PointView& view, uint32_t room, double angle, std::vector<SkySample>& samples,
                        std::vector<OutsideShare>* walls) const {
    PointView::Polygon halves[2];
    const auto sky = [&](const PointView::Polygon& part, const GlassBefore& glass) {
        splitAtHorizon(part, halves[0], halves[1]);
        for (size_t half = 0; half < 2; ++half) {
            if (halves[half].size() < 3) continue;
            const double factor = view.unhinderedFactor(halves[half]);
            const size_t first = samples.size();
            double weights = 0;
            forCells(halves[half], view.normal(), angle, [&](dvec3 centre, double weight) {
                const dvec3 direction = glm::normalize(centre);
                samples.push_back({glm::vec3(direction), glm::vec3(weight * glass.transmittance(direction))});
                weights += weight;
            });
            const auto scale = static_cast<float>(scaleOfCells(factor, weights));
            for (size_t k = first; k < samples.size(); ++k) {
                samples[k].weight *= scale;
                if (half == 1) samples[k].direction.y = std::min(samples[k].direction.y, 0.0f);
            }
        }
    };
    const auto wall = [&](const PointView::Polygon& part, size_t region, const GlassBefore& glass) {
        seeWall(view, part, region, glass, angle, *walls);
    };
    const bool seesWalls = walls && !outside_.cells().empty();
    forOutside(view, room, sky, seesWalls ? OutsideWallWork(wall) : OutsideWallWork());
}

void PointScene::seeWallsBefore(uint32_t patch, double angle, const CellWork& work) const {
    const dvec3 middle = patches_[patch].centre, outwards = -patches_[patch].normal;
    const geometry::Bounds here{middle, middle};
    const double near = kSamePlane * geometry::boundsOf(mesh_->vertices).diagonal();
    const auto own = std::ranges::find_if(openings_, [&](const Opening& opening) {
        return opening.region.room == mesh_->room[patch] && opening.region.group == mesh_->material[patch] &&
               std::abs(glm::dot(middle - opening.region.corners[0], opening.normal)) <= near &&
               geometry::boundsOf(opening.region.corners).isNear(here, near);
    });
    if (own == openings_.end()) return;
    const PointView view(blockers_, middle, outwards);
    std::vector<const PointView::Polygon*> hiding;
    for (const PointView::Polygon& polygon : own->hiddenBy) hiding.push_back(&polygon);
    const PointView::Hiding before = view.hidingBehind(hiding);
    std::vector<PointView::Polygon> parts;
    for (const auto& [region, wall] : own->walls) {
        if (!isBefore(middle, region) || view.factor(wall, parts) <= 0) continue;
        view.hideBehind(before, parts);
        for (const PointView::Polygon& part : parts)
            forSamples(view, part, angle, [&, at = region](dvec3 centre, double factor) {
                work(outside_.cellAt(at, middle + centre), glm::normalize(centre), factor);
            });
    }
}

bool PointScene::isBefore(dvec3 point, size_t region) const {
    const ConvexRegion& whole = outside_.regions()[region];
    return glm::dot(point - whole.corners[0], normalOf(whole)) > blockers_.tolerance();
}

} // namespace heliodon::compute
