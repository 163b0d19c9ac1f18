#pragma once
#include "tracking/camera/camera.hpp"

namespace heartservo::test {

/// The paper's endoscope, Table 2.
inline tracking::Camera table2_camera() {
  tracking::Camera camera;
  camera.width = camera.height = 512;
  camera.fx = 593.6;
  camera.fy = 594.5;
  camera.cx = 279.6;
  camera.cy = 223.7;
  camera.k1 = -0.241;
  camera.k2 = 0.207;
  camera.k3 = 0.005;
  camera.k4 = 0.008;
  return camera;
}

}  // namespace heartservo::test
