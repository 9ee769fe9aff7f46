// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/mask_picture.h"

namespace semantic_vslam {

cv::Mat3b maskPicture(const cv::Mat3b& bgr, const cv::Mat1b& dynamic) {
  constexpr int kLeft = 128;  // of 255: the person stays to be seen
  cv::Mat3b picture = bgr.clone();
  if (dynamic.empty()) return picture;
  CV_Assert(bgr.size() == dynamic.size());
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const int moves = dynamic(y, x);
      if (moves < 128) continue;
      cv::Vec3b& pixel = picture(y, x);
      const int red = moves * (255 - kLeft) / 255;
      for (int channel = 0; channel < 3; ++channel)
        pixel[channel] = cv::saturate_cast<uchar>(pixel[channel] * (255 - red) / 255);
      pixel[2] = cv::saturate_cast<uchar>(pixel[2] + red);
    }
  }
  return picture;
}

}  // namespace semantic_vslam
