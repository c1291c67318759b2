#include "compute/refinement_forecast.h"

#include <algorithm>

namespace heliodon::compute {

namespace {

constexpr double kUnseen = 0.5; // growth where nothing is known, at most

} // namespace

void RefinementForecast::step(uint32_t depth, uint32_t taken, uint32_t made) {
    if (depths_.size() < depth + 2) depths_.resize(depth + 2);
    depths_[depth].waiting -= taken;
    depths_[depth].taken += taken;
    depths_[depth].made += made;
    depths_[depth + 1].waiting += made;
    if (watch_)
        timed_ += taken;
    else
        watch_.emplace();
}

double RefinementForecast::workLeft() const {
    if (timed_ <= 0) return 0;
    double left = 0, each = 1 / (1 - kUnseen); // all that comes of a cell, itself included
    for (auto d = depths_.rbegin(); d != depths_.rend(); ++d) {
        if (d->taken > 0) each = 1 + d->made / d->taken * each;
        left += std::max(0.0, d->waiting) * each;
    }
    return left / timed_;
}

void PartsForecast::begin(double share) {
    if (begun_ == 0)
        first_ = share;
    else if (!watch_)
        watch_.emplace();
    begun_ += share;
}

double PartsForecast::secondsLeft(double ofThisPart) const {
    if (!watch_) return ofThisPart;
    const double spent = watch_->seconds();
    return (spent + ofThisPart) * (1 - first_) / (begun_ - first_) - spent;
}

} // namespace heliodon::compute
