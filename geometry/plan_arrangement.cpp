#include "geometry/plan_arrangement.h"

#include <algorithm>
#include <unordered_map>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Arr_consolidated_curve_data_traits_2.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#pragma GCC diagnostic pop

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Traits = CGAL::Arr_consolidated_curve_data_traits_2<CGAL::Arr_segment_traits_2<Kernel>, int32_t>;
using Arrangement = CGAL::Arrangement_2<Traits>;

} // namespace

PlanArrangement arrange(std::span<const PlanSegment> segments) {
    std::vector<Traits::Curve_2> curves;
    for (size_t i = 0; i < segments.size(); ++i) {
        const PlanSegment& s = segments[i];
        const Traits::Base_traits_2::Curve_2 base(Kernel::Point_2(s.a.x, s.a.y),
                                                  Kernel::Point_2(s.b.x, s.b.y));
        curves.emplace_back(base, static_cast<int32_t>(i));
    }
    Arrangement exact;
    CGAL::insert(exact, curves.begin(), curves.end());

    PlanArrangement out;
    std::unordered_map<const void*, uint32_t> pointOf, halfOf, cellOf;
    for (auto v = exact.vertices_begin(); v != exact.vertices_end(); ++v) {
        pointOf[&*v] = static_cast<uint32_t>(out.points.size());
        out.points.emplace_back(CGAL::to_double(v->point().x()), CGAL::to_double(v->point().y()));
    }
    cellOf[&*exact.unbounded_face()] = out.cellCount++;
    for (auto f = exact.faces_begin(); f != exact.faces_end(); ++f)
        if (cellOf.try_emplace(&*f, out.cellCount).second) ++out.cellCount;
    std::vector<Arrangement::Halfedge_const_handle> halves;
    for (auto e = exact.edges_begin(); e != exact.edges_end(); ++e)
        for (const Arrangement::Halfedge_const_handle h :
             {Arrangement::Halfedge_const_handle(e), Arrangement::Halfedge_const_handle(e->twin())}) {
            halfOf[&*h] = static_cast<uint32_t>(halves.size());
            halves.push_back(h);
        }
    for (const auto& h : halves) {
        out.target.push_back(pointOf.at(&*h->target()));
        out.next.push_back(halfOf.at(&*h->next()));
        out.cell.push_back(cellOf.at(&*h->face()));
    }
    for (size_t e = 0; e < halves.size() / 2; ++e) {
        // Which way the edge runs is exact: ends are ordered lexicographically along every segment.
        const bool rises = halves[2 * e]->direction() == CGAL::ARR_LEFT_TO_RIGHT;
        std::vector<PlanArrangement::Tag> tags;
        for (const int32_t i : halves[2 * e]->curve().data()) {
            const PlanSegment& s = segments[static_cast<size_t>(i)];
            tags.push_back({s.tag, (std::pair(s.a.x, s.a.y) < std::pair(s.b.x, s.b.y)) == rises});
        }
        std::ranges::sort(tags, {},
                          [](const PlanArrangement::Tag& t) { return std::pair(t.tag, t.forward); });
        out.tags.push_back(std::move(tags));
    }
    return out;
}

} // namespace heliodon::geometry
