// Coloured regions that may be several walls at once, cut into pieces of one wall each.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/components.h"
#include "vision/plan_view.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {

bool isLightBlue(const Component& region); // as skylights' card is

// What to say of a region of walls' paint that is left out.
const char* whyNoWall(const Component& region);

class RegionCutter {
public:
    // All outlive this. `radius` of the table: inches.
    RegionCutter(ClassImage& image, const PlanView& view, const DetectOptions& options, double radius)
        : image_(image), view_(view), options_(options), radius_(radius) {}

    struct Pieces {
        std::vector<const Component*>
            pieces;                   // strips and arcs: the region, or parts that live with the cutter
        const char* unread = nullptr; // why the region, or something of it, is left out
    };
    // Where what is pale in the region is cut away, the picture has no paint there any more.
    Pieces piecesOf(const Component& region);

    // Whether a region that is pale or light blue in part has strips or arcs of vivid paint.
    bool hasVividPieces(const Component& region) const;

private:
    bool addVivid(const Component& region, Pieces& out);
    bool addPiecesOf(const std::optional<ClassImage>& vivid, const Component& region, Pieces& out);
    std::vector<Component> vividPieces(const std::optional<ClassImage>& vivid) const;
    bool isVividPiece(const Component& part) const;
    void addStrips(const Component& region, Pieces& out);
    void leaveOutRims(const Component& region, Pieces& out) const;
    int areaOf(Paint paint, const Component& region) const;
    std::optional<geometry::Arc> followArc(Component& strip, const Component& region) const;
    Component alongArc(const Component& region, const geometry::Arc& arc) const;
    bool isOn(const geometry::Arc& arc, glm::dvec2 pixel) const;
    bool liesOnOne(const std::vector<geometry::Arc>& arcs, const Component& strip) const;
    void keep(Component&& part, Pieces& out);
    WallEvidence evidence() const { return {image_, view_, options_, radius_}; }

    ClassImage& image_;
    const PlanView& view_;
    const DetectOptions& options_;
    double radius_;
    std::deque<Component> parts_; // where they are does not change
};

} // namespace heliodon::vision
