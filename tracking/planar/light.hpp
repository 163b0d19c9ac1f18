#pragma once

namespace heartservo::tracking {

/// How the picture is lit against the template: template = (gain + gain_offset) * picture + bias.
struct Light {
  double gain = 1, bias = 0;           ///< bias in grey levels
  const float* gain_offset = nullptr;  ///< of every point of the patch, or null
};

}  // namespace heartservo::tracking
