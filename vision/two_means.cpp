#include "vision/two_means.h"

#include <opencv2/imgproc.hpp>

namespace heliodon::vision {

cv::Mat twoMeans(const cv::Mat& from, int size) {
    cv::Mat out;
    cv::blur(from, out, {size, size}, {-1, -1}, cv::BORDER_CONSTANT);
    cv::blur(out, out, {size, size}, {-1, -1}, cv::BORDER_CONSTANT);
    return out;
}

} // namespace heliodon::vision
