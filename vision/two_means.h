// Two running means in a row: close to a Gaussian, at a cost that does not grow with its width.
#pragma once

namespace cv {
class Mat;
}

namespace heliodon::vision {

// Of squares of `size`, odd; nothing lies beyond the edge. A deviation of sqrt((size^2 - 1) / 6).
cv::Mat twoMeans(const cv::Mat& from, int size);

} // namespace heliodon::vision
