#include "geometry/blind.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "geometry/number_text.h"

namespace heliodon::geometry {

namespace {

struct Range {
    const char* name;
    double low, high, standard; // standard: where it is not given
};

// Numbers with commas between, at least the first `needed` of them.
std::vector<double> numbersOf(std::string_view text, size_t needed, const std::vector<Range>& ranges) {
    std::vector<double> values;
    size_t at = 0;
    for (const Range& range : ranges) {
        if (at > text.size() || (text.empty() && values.size() >= needed)) {
            if (values.size() < needed) throw std::invalid_argument(fmt::format("{} is missing", range.name));
            values.push_back(range.standard);
            continue;
        }
        const size_t comma = std::min(text.find(',', at), text.size());
        const std::optional<double> value = numberFrom(text.substr(at, comma - at));
        if (!value || *value < range.low || *value > range.high)
            throw std::invalid_argument(fmt::format("{} is '{}', expected {:g} to {:g}", range.name,
                                                    text.substr(at, comma - at), range.low, range.high));
        values.push_back(*value);
        at = comma + 1;
    }
    if (at <= text.size())
        throw std::invalid_argument(fmt::format("'{}' is more than there is to say", text.substr(at)));
    return values;
}

} // namespace

Blind parseBlind(std::string_view text) {
    const size_t colon = std::min(text.find(':'), text.size());
    const std::string_view kind = text.substr(0, colon),
                           rest = colon < text.size() ? text.substr(colon + 1) : std::string_view{};
    Blind blind;
    if (kind == "fabric" && colon < text.size()) {
        const auto v =
            numbersOf(rest, 1, {{"the transmittance", 0, 1, 0}, {"the reflectance", 0, 0.999, -1}});
        blind.kind = Blind::Kind::fabric;
        blind.transmittance = static_cast<float>(v[0]);
        // What is not said: half of what does not pass, as of middling fabrics.
        blind.reflectance = static_cast<float>(v[1] < 0 ? 0.5 * (1 - v[0]) : v[1]);
        if (double{blind.transmittance} + double{blind.reflectance} > 1 + 1e-6)
            throw std::invalid_argument("a fabric cannot pass and reflect more than 1");
    } else if (kind == "slats" && colon < text.size()) {
        const auto v = numbersOf(
            rest, 1,
            {{"the angle", -85, 85, 0}, {"the reflectance", 0, 0.999, 0.7}, {"the spacing", 0.05, 10, 0.8}});
        blind.kind = Blind::Kind::slats;
        blind.slatAngleDeg = static_cast<float>(v[0]);
        blind.reflectance = static_cast<float>(v[1]);
        blind.slatSpacing = static_cast<float>(v[2]);
    } else if (text != "open") {
        throw std::invalid_argument("is no state, expected open, fabric:T[,R] or slats:ANGLE[,R[,SPACING]]");
    }
    return blind;
}

std::string blindText(const Blind& blind) {
    switch (blind.kind) {
    case Blind::Kind::fabric:
        return fmt::format("fabric:{},{}", blind.transmittance, blind.reflectance);
    case Blind::Kind::slats:
        return fmt::format("slats:{},{},{}", blind.slatAngleDeg, blind.reflectance, blind.slatSpacing);
    case Blind::Kind::none:
        break;
    }
    return "open";
}

} // namespace heliodon::geometry
