// How long work will go on. Of refinement by levels: cells that wait at each depth become as many as others
// of that depth have become so far. Low at first, where depths that nothing has reached yet split further: in
// the first tenth of the time it comes to 0.3 to 0.6 of all, later to 0.6 to 1.6 (five runs of 3 to 125 s
// among boards, beams and loose triangles, at 1e-4 to 1e-3). Of parts: those to come cost as much for their
// share as those before.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compute/stopwatch.h"

namespace heliodon::compute {

class RefinementForecast {
public:
    // `waiting`: cells of depth 0.
    explicit RefinementForecast(uint32_t waiting) : depths_{{double(waiting), 0, 0}} {}

    // `taken` of the cells that waited at a depth are done, and made so many of the next.
    void step(uint32_t depth, uint32_t taken, uint32_t made);

    // Cells yet to be done, over those done from the second step on: what they cost decides, and the first
    // step may have made its kernel. 0 before.
    double workLeft() const;
    double secondsTimed() const { return watch_ ? watch_->seconds() : 0; }
    double secondsLeft() const { return secondsTimed() * workLeft(); }

private:
    struct Depth {
        double waiting = 0, taken = 0, made = 0; // cells
    };
    std::vector<Depth> depths_;
    std::optional<Stopwatch> watch_; // from the end of the first step
    double timed_ = 0;               // cells done since
};

class PartsForecast {
public:
    // The next part, `share` of all work.
    void begin(double share);

    // From the second part on, since the first may have made kernels; before, `ofThisPart` itself.
    double secondsLeft(double ofThisPart) const;

private:
    double first_ = 0, begun_ = 0;   // shares: of the first part, of all that have begun
    std::optional<Stopwatch> watch_; // from the beginning of the second
};

} // namespace heliodon::compute
