#include "compute/link_claims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "compute/chi_squared.h"

namespace heliodon::compute {

namespace {

constexpr double kNotWanted = std::numeric_limits<double>::infinity();
constexpr double kBelowBound = 0.8; // of the bound, at which rows above it aim
constexpr double kAlike = 0.15;     // share of triangles' errors that have one sign (measured)
// Over the estimates, in scenes where few blockers hide much, whose links err most (measured).
constexpr double kCaution = 1.15, kRowCaution = 2.2, kSumCaution = 1.9, kBiasCaution = 2;
constexpr double kMostUnseen = 2.0;  // rays' worth that rays which agree may have missed
constexpr double kLeastShare = 0.05; // of a row's squares, from which a cluster is worth taking apart
constexpr double kGain = 0.7;        // of a link's error, gone when it is split (a guess: more rounds follow)

// Standard deviations of the 99th percentile; more for sums of rows, to which few pairs of triangles
// contribute that rays saw alike by luck: no normal distribution.
constexpr double kPercentile = 2.326, kSumPercentile = 4.5;

// Such a percentile of the root of a sum of squares over its expectation, of independent normal terms with
// variances that add up to `sum` and their squares to `squares`.
double percentile(double sum, double squares, double deviations = kPercentile) {
    if (!(sum > 0 && squares > 0)) return 1;
    return std::sqrt(chiSquaredOverMean(chiSquaredSpread(sum, squares), deviations));
}

// No form factor is off by more than one, whatever an estimate makes of tiny patches before large ones.
double errorOfSum(const PatchTree& tree, const io::HierarchicalLink& link, bool first) {
    return std::min(double{link.error} * tree.nodes[first ? link.second : link.first].area, 1.0);
}

} // namespace

LinkClaims::LinkClaims(const PatchTree& tree, std::span<const double> patchArea,
                       std::span<const io::HierarchicalLink> links)
    : tree_(&tree), patchArea_(patchArea.begin(), patchArea.end()), entryArea_(tree.nodes.size()),
      entries_(tree.nodes.size()), sums_(tree.nodes.size()), squares_(tree.nodes.size()),
      ofEntries_(tree.nodes.size()), ofSquares_(tree.nodes.size()), found_(tree.nodes.size()),
      agreed_(tree.nodes.size()) {
    // Entries are those of patches: triangles of one patch err alike, but for pieces that something covers,
    // which exchange light with that alone. Children come after their parents.
    for (size_t k = tree.nodes.size(); k-- > 0;) {
        const PatchTree::Node& node = tree.nodes[k];
        entryArea_[k] = node.child != 0 ? entryArea_[node.child] + entryArea_[node.child + 1]
                        : node.covered  ? node.area * node.area
                                        : node.area * patchArea_[tree.leaves[node.firstLeaf].patch];
    }
    add(links);
}

void LinkClaims::add(std::span<const io::HierarchicalLink> links) {
    for (const io::HierarchicalLink& link : links) count(link, 1);
}

void LinkClaims::count(const io::HierarchicalLink& link, double sign) {
    const auto countEntries = [&](uint32_t row, uint32_t of) {
        const double error = errorOfSum(*tree_, link, row == link.first) / tree_->nodes[of].area;
        const double variance = error * error * entryArea_[of];
        entries_[row] += sign * variance;
        ofEntries_[row] +=
            sign * variance * variance / tree_->nodes[of].leafCount; // each triangle's by itself
    };
    countEntries(link.first, link.second);
    countEntries(link.second, link.first);
    const double a = errorOfSum(*tree_, link, true), b = errorOfSum(*tree_, link, false);
    sums_[link.first] += sign * a;
    sums_[link.second] += sign * b;
    squares_[link.first] += sign * a * a;
    squares_[link.second] += sign * b * b;
    ofSquares_[link.first] += sign * a * a * a * a;
    ofSquares_[link.second] += sign * b * b * b * b;
    const auto countBias = [&](uint32_t row, uint32_t of) {
        const double area = sign * tree_->nodes[of].area;
        found_[row] += area * (double{link.density} - double{link.unbiased});
        if (link.agreed > 0) agreed_[row] += area * double{link.density} / link.agreed;
    };
    countBias(link.first, link.second);
    countBias(link.second, link.first);
}

double LinkClaims::rowError() const {
    const std::vector<double> squares = rowSquares();
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    return std::sqrt(sum / std::max<double>(static_cast<double>(squares.size()), 1));
}

std::vector<double> LinkClaims::rowClaims() const {
    std::vector<double> claims = rowSquares();
    const std::vector<double> squares = overPatches(ofEntries_, false);
    for (size_t i = 0; i < claims.size(); ++i)
        claims[i] = kRowCaution * std::sqrt(claims[i]) * percentile(claims[i], squares[i]);
    return claims;
}

double LinkClaims::claim(double share) const {
    const std::vector<double> rows = rowSquares(), squares = overPatches(ofEntries_, false);
    const double sum = std::accumulate(rows.begin(), rows.end(), 0.0);
    // Each link errs in the rows of both ends alike.
    return kCaution * (1 + unseen()) * rowError() / std::sqrt(share) *
           percentile(sum, 2 * share * std::accumulate(squares.begin(), squares.end(), 0.0));
}

std::vector<glm::uvec2> LinkClaims::takeAbove(std::vector<io::HierarchicalLink>& links, double bound) {
    std::vector<glm::uvec2> pairs;
    std::erase_if(links, [&](const io::HierarchicalLink& link) {
        if (std::max(errorOfSum(*tree_, link, true), errorOfSum(*tree_, link, false)) <= bound) return false;
        count(link, -1);
        pairs.push_back({link.first, link.second});
        return true;
    });
    return pairs;
}

// Rays' worth of what links have too much, spread over those whose rays all passed.
double LinkClaims::unseen() const {
    double found = 0, agreed = 0;
    for (size_t k = 0; k < found_.size(); ++k) {
        if (tree_->nodes[k].child) continue;
        found += tree_->nodes[k].area * found_[k];
        agreed += tree_->nodes[k].area * agreed_[k];
    }
    return agreed > 0 ? std::clamp(found / agreed, 0.0, kMostUnseen) : 0;
}

void LinkClaims::takeUnseen(std::span<io::HierarchicalLink> links) const {
    const double rays = unseen();
    for (io::HierarchicalLink& link : links)
        if (link.agreed > 0) link.density *= static_cast<float>(1 - rays / link.agreed);
}

std::vector<double> LinkClaims::sumSquares() const {
    std::vector<double> squares(sums_.size());
    const double rays = unseen();
    for (size_t k = 0; k < sums_.size(); ++k) {
        const double taken = rays * agreed_[k]; // by the mean over all, which may be no better here than none
        squares[k] = taken * taken;
        if (tree_->nodes[k].child) {
            squares[k] += sums_[k] * sums_[k];
            continue;
        }
        const double independent = std::max(0.0, squares_[k]);
        squares[k] +=
            independent * std::pow(kSumCaution * percentile(independent, ofSquares_[k], kSumPercentile), 2);
        squares[k] += std::pow(kAlike * sums_[k], 2) + std::pow(kBiasCaution * (found_[k] - taken), 2);
    }
    return squares;
}

std::vector<double> LinkClaims::overPatches(std::vector<double> perNode, bool root) const {
    for (size_t k = 0; k < perNode.size(); ++k)
        if (tree_->nodes[k].parent != PatchTree::kNone) perNode[k] += perNode[tree_->nodes[k].parent];
    std::vector<double> rows(patchArea_.size(), 0.0);
    for (const PatchTree::Leaf& leaf : tree_->leaves) {
        const double value = std::max(0.0, perNode[leaf.node]);
        rows[leaf.patch] += leaf.area / patchArea_[leaf.patch] * (root ? std::sqrt(value) : value);
    }
    return rows;
}

// Of each cluster that has much to do with rows above the bound, what its links' errors may add up to.
std::vector<double> LinkClaims::wantedSums(double bound) const {
    const std::vector<double> squares = sumSquares();
    std::vector<double> wanted(squares.size(), kNotWanted);
    for (const PatchTree::Leaf& leaf : tree_->leaves) {
        double sum = 0;
        for (uint32_t p = leaf.node; p != PatchTree::kNone; p = tree_->nodes[p].parent) sum += squares[p];
        if (sum <= bound * bound) continue;
        const double share = kBelowBound * bound / std::sqrt(sum);
        for (uint32_t p = leaf.node; p != PatchTree::kNone; p = tree_->nodes[p].parent)
            if (tree_->nodes[p].child && squares[p] > kLeastShare * sum)
                wanted[p] = std::min(wanted[p], share * std::sqrt(squares[p]));
    }
    return wanted;
}

std::vector<glm::uvec2> LinkClaims::split(std::vector<io::HierarchicalLink>& links, double bound) {
    struct Candidate {
        double error;
        size_t link;
        bool operator<(const Candidate& other) const { // of links alike, the earlier one is the greater
            return error != other.error ? error < other.error : link > other.link;
        }
    };
    struct Split {
        bool first = false, second = false;
    };
    const std::vector<double> wanted = wantedSums(bound);
    if (std::all_of(wanted.begin(), wanted.end(), [](double w) { return w == kNotWanted; })) return {};
    std::vector<std::vector<Candidate>> candidates(wanted.size()); // per node
    for (size_t l = 0; l < links.size(); ++l)
        for (const bool first : {true, false}) {
            const uint32_t node = first ? links[l].first : links[l].second;
            if (wanted[node] < kNotWanted && links[l].error > 0)
                candidates[node].push_back({errorOfSum(*tree_, links[l], first), l});
        }
    std::vector<Split> splits(links.size());
    for (size_t node = 0; node < candidates.size(); ++node) {
        std::vector<Candidate>& heap = candidates[node];
        std::make_heap(heap.begin(), heap.end());
        for (double left = sums_[node]; left > wanted[node] && !heap.empty(); heap.pop_back()) {
            std::pop_heap(heap.begin(), heap.end());
            const Candidate& largest = heap.back();
            left -= kGain * largest.error;
            Split& split = splits[largest.link];
            (links[largest.link].first == node ? split.first : split.second) = true;
        }
    }
    std::vector<glm::uvec2> pairs;
    size_t kept = 0;
    for (size_t l = 0; l < splits.size(); ++l) {
        const io::HierarchicalLink& link = links[l];
        const Split& split = splits[l];
        if (!split.first && !split.second) {
            links[kept++] = link;
            continue;
        }
        count(link, -1);
        for (uint32_t a = 0; a < (split.first ? 2u : 1u); ++a)
            for (uint32_t b = 0; b < (split.second ? 2u : 1u); ++b)
                pairs.push_back({split.first ? tree_->nodes[link.first].child + a : link.first,
                                 split.second ? tree_->nodes[link.second].child + b : link.second});
    }
    links.resize(kept);
    return pairs;
}

} // namespace heliodon::compute
