#include "vision/table_watch.h"

#include <algorithm>
#include <cmath>

namespace heliodon::vision {

namespace {

double secondsFrom(TableWatch::Time from, TableWatch::Time to) {
    return std::chrono::duration<double>(to - from).count();
}

} // namespace

TableWatch::Blocks TableWatch::blocksOf(const Photograph& photo) const {
    const int size = options_.blockPx;
    Blocks blocks{photo.width / size, photo.height / size, {}};
    blocks.mean.reserve(static_cast<size_t>(3 * blocks.across * blocks.down));
    for (int by = 0; by < blocks.down; ++by)
        for (int bx = 0; bx < blocks.across; ++bx) {
            unsigned sum[3] = {0, 0, 0};
            unsigned count = 0;
            for (int y = by * size; y < (by + 1) * size; y += 2) // every second pixel, as on a chequerboard
                for (int x = bx * size + (y / 2) % 2; x < (bx + 1) * size; x += 2, ++count) {
                    const uint8_t* pixel =
                        &photo.rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(photo.width) +
                                        static_cast<size_t>(x))];
                    for (int c = 0; c < 3; ++c) sum[c] += pixel[c];
                }
            for (unsigned s : sum) blocks.mean.push_back(static_cast<float>(s) / static_cast<float>(count));
        }
    return blocks;
}

bool TableWatch::differ(const Blocks& a, const Blocks& b) const {
    if (a.across != b.across || a.down != b.down) return true;
    double sumA = 0, sumB = 0;
    for (size_t i = 0; i < a.mean.size(); ++i) sumA += a.mean[i], sumB += b.mean[i];
    const float gain = sumB > 0 ? static_cast<float>(std::clamp(sumA / sumB, 0.8, 1.25)) : 1.0f;
    int blocks = 0;
    for (size_t i = 0; i < a.mean.size(); i += 3) {
        float most = 0;
        for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.mean[i + c] - gain * b.mean[i + c]));
        if (most > options_.blockStep && ++blocks >= options_.leastBlocks) return true;
    }
    return false;
}

bool TableWatch::lightIsChanging(Time taken) const {
    return secondsFrom(lightChanged_, taken) < options_.lightSeconds;
}

TableWatch::State TableWatch::look(const Photograph& photo, Time taken) {
    Blocks now = blocksOf(photo);
    const bool ownLight = lightIsChanging(taken);
    // What moved while the light changed is not known: start anew with the first picture after that.
    const bool moved = !ownLight && !skipped_ && last_ && differ(*last_, now);
    skipped_ = ownLight;
    const bool first = !last_;
    last_ = std::move(now);
    if (moved) moved_ = taken;
    if (first && moved_ == Time{}) moved_ = taken;
    if (ownLight || secondsFrom(moved_, taken) < options_.steadySeconds) return State::moving;
    return worked_ && !differ(*worked_, *last_) ? State::same : State::changed;
}

} // namespace heliodon::vision
