#pragma once
#include <opencv2/core/mat.hpp>
#include <vector>

namespace heartservo::tracking {

/// Half the size, smoothed by the Gaussian kernel (1, 4, 6, 4, 1) / 16 along both axes, mirrored at the borders: what
/// cv::pyrDown does to float pictures, to rounding, with the memory that it is given. `from`: CV_8UC1 or CV_32FC1;
/// `to`: CV_32FC1 of ((columns + 1) / 2, (rows + 1) / 2).
void halve(const cv::Mat& from, cv::Mat& to, std::vector<float>& scratch);

}  // namespace heartservo::tracking
