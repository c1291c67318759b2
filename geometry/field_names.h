// Fields of JSON files that nobody reads: what is misspelt is named, with what was meant.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace heliodon::geometry {

// The one of `known` that `name`, none of them, may be misspelt for: "windows" for "widnows", whatever their
// case. Near: by an edit in four letters, a letter more, less or other, or two that have changed places.
// Or with the same first three letters, "projector_count". The nearest; empty where there is none.
enum class Alike { near, nearOrSameStart };
std::string_view meantBy(std::string_view name, std::span<const std::string_view> known,
                         Alike alike = Alike::nearOrSameStart);

struct OtherField {
    std::string name;
    std::string_view meant; // one of those known; empty where nothing is like it
};

// The fields of `object` that are none of `known`, in its order; of what is no object, none. Json:
// nlohmann::json or ordered_json.
template<class Json>
std::vector<OtherField> otherFields(const Json& object, std::span<const std::string_view> known,
                                    Alike alike = Alike::nearOrSameStart) {
    std::vector<OtherField> others;
    if (!object.is_object()) return others;
    for (const auto& [name, ignored] : object.items())
        if (std::ranges::find(known, std::string_view(name)) == known.end())
            others.push_back({name, meantBy(name, known, alike)});
    return others;
}

// For a warning: appends "projectors[0].lumnes (lumens?)", with `place`, the object's own, before each. Where
// notes of other programs are welcome, only what may be misspelt.
enum class Notes { unexpected, welcome };
void listOthers(const std::vector<OtherField>& others, const std::string& place, Notes notes,
                std::vector<std::string>& list);

} // namespace heliodon::geometry
