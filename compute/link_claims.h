// What links between clusters leave open in each patch's row of form factors, and which of them to take apart
// where that is too much.
#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "compute/patch_tree.h"
#include "shaders/io/hierarchical.io.h"

namespace heliodon::compute {

// Of single entries, links err independently of one another: variances add up, from the roots down to the
// patches. Of a row's sum they do not: where the foot of a blocker or the border of a shadow divides a
// cluster, one of its triangles sees more, or less, than the cluster does along all of its links alike. So
// errors of a cluster's links add up; of different clusters' links, and mostly of triangles' own, their
// squares.
//
// And some errors all have one sign. Pairs of triangles whose first rays all pass end there, the others go on
// and find less (D. Kirk, J. Arvo, "Unbiased Sampling Techniques for Image Synthesis", 1991): behind blockers
// too small for few rays every pair exchanges a little too much. What all pairs' first rays say has no such
// bias: the difference tells it, and most is taken from the links whose rays agreed.
//
// Where few links make most of an error, luck decides by how much it is above what is to be expected: claims
// are 99th percentiles of sums of as many squares (chi_squared.h).
class LinkClaims {
public:
    // `tree` must outlive this. O(links).
    LinkClaims(const PatchTree& tree, std::span<const double> patchArea,
               std::span<const io::HierarchicalLink> links);

    void add(std::span<const io::HierarchicalLink> links);

    // Estimates per patch: the square of ||F_i - true||, and |sum_j F_ij - true|.
    std::vector<double> rowSquares() const { return overPatches(entries_, false); }
    std::vector<double> rowSums() const { return overPatches(sumSquares(), true); }
    double rowError() const; // RMS over rows of ||F_i - true||

    // Below which 99 of 100 such errors are: of each row, and of the RMS over rows.
    std::vector<double> rowClaims() const;
    // The latter of all links, if those counted here are a `share` of them picked at random.
    double claim(double share = 1) const;

    // Takes out of `links`, all of which were counted here, those whose form factor from the lesser end to
    // the larger may err by more than `bound`, and returns the pairs of nodes that they link.
    std::vector<glm::uvec2> takeAbove(std::vector<io::HierarchicalLink>& links, double bound);

    // Takes out of `links`, all of which were counted here, those by which sums of rows may be off by more
    // than `bound`, the largest first, and returns the pairs of nodes to link in their place. Empty: none.
    std::vector<glm::uvec2> split(std::vector<io::HierarchicalLink>& links, double bound);

    // Takes from `links`, all of which were counted here, what rays that agreed have missed on average;
    // claims are of what is left.
    void takeUnseen(std::span<io::HierarchicalLink> links) const;

private:
    double unseen() const;
    void count(const io::HierarchicalLink& link, double sign);
    std::vector<double> sumSquares() const; // per node
    std::vector<double> overPatches(std::vector<double> perNode, bool root) const;
    std::vector<double> wantedSums(double bound) const;

    const PatchTree* tree_;
    std::vector<double> patchArea_;
    std::vector<double> entryArea_; // per node: of areas over which an error's square counts in a row
    // Per node: variance of rows; errors of sums, in all and, at triangles, their squares. Of the first and
    // the last what single links add, squared.
    std::vector<double> entries_, sums_, squares_, ofEntries_, ofSquares_;
    // Per node, of what its links carry: what rays that went on say less what the first of them did; and of
    // links whose rays all passed, over the number of these.
    std::vector<double> found_, agreed_;
};

} // namespace heliodon::compute
