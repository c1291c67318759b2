// What was made of the last few things, for where they are asked for again and again.
#pragma once

#include <cstring>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// Keys are equal to the bit.
template<class Made> class Kept {
public:
    template<class Make> Made get(std::vector<double> key, Make make) {
        for (const auto& [known, made] : last_)
            if (known.size() == key.size() &&
                std::memcmp(known.data(), key.data(), key.size() * sizeof(double)) == 0)
                return made;
        Made made = make();
        numbers_ += key.size();
        last_.emplace_back(std::move(key), made);
        for (; last_.size() > kFew && numbers_ > kMostNumbers; last_.pop_front())
            numbers_ -= last_.front().first.size();
        return made;
    }

private:
    static constexpr size_t kFew = 3, kMostNumbers = 5000000; // of keys: some 200 MB with what was made
    std::deque<std::pair<std::vector<double>, Made>> last_;
    size_t numbers_ = 0;
};

// While one lives, the thread keeps what it made of a kind. One of a kind at a time.
template<class Made> class Memory {
public:
    Memory() { kept().emplace(); }
    ~Memory() { kept().reset(); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // `key()` is asked for only while one lives.
    template<class Key, class Make> static Made get(Key key, Make make) {
        return kept() ? kept()->get(key(), make) : make();
    }

private:
    static std::optional<Kept<Made>>& kept() {
        thread_local std::optional<Kept<Made>> kept;
        return kept;
    }
};

inline void addOutline(std::vector<double>& key, const std::vector<std::vector<glm::dvec3>>& loops) {
    key.push_back(static_cast<double>(loops.size()));
    for (const auto& loop : loops) {
        key.push_back(static_cast<double>(loop.size()));
        for (const glm::dvec3& p : loop) key.insert(key.end(), {p.x, p.y, p.z});
    }
}

} // namespace heliodon::geometry
