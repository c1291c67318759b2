#include "geometry/field_names.h"

#include <numeric>

#include "geometry/lower_case.h"

namespace heliodon::geometry {

namespace {

// Optimal string alignment: the distance of V. I. Levenshtein (1966), neighbours changing places counting one
// after F. J. Damerau (1964).
size_t editsBetween(std::string_view a, std::string_view b) {
    std::vector<size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
    std::iota(last.begin(), last.end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i) {
        now[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = std::min(now[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, now);
    }
    return last[b.size()];
}

} // namespace

std::string_view meantBy(std::string_view name, std::span<const std::string_view> known, Alike alike) {
    constexpr size_t kSameStart = 3, kLongest = 64; // no name of a field is longer
    std::string_view meant;
    if (name.size() > kLongest) return meant;
    const std::string written = lowered(name);
    size_t fewest = kLongest + 1;
    for (const std::string_view candidate : known) {
        const std::string other = lowered(candidate);
        const size_t edits = editsBetween(written, other);
        const bool near = edits <= (std::max(written.size(), other.size()) + 1) / 4,
                   sameStart = written.substr(0, kSameStart) == other.substr(0, kSameStart);
        if ((near || (sameStart && alike == Alike::nearOrSameStart)) && edits < fewest)
            meant = candidate, fewest = edits;
    }
    return meant;
}

void listOthers(const std::vector<OtherField>& others, const std::string& place, Notes notes,
                std::vector<std::string>& list) {
    for (const OtherField& other : others) {
        if (notes == Notes::welcome && other.meant.empty()) continue;
        std::string text = place.empty() ? other.name : place + "." + other.name;
        if (!other.meant.empty()) text += " (" + std::string(other.meant) + "?)";
        list.push_back(std::move(text));
    }
}

} // namespace heliodon::geometry
