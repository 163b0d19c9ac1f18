#pragma once
// Poses and pictures of a running loop for 3D Slicer and other clients, by OpenIGTLink version 1 messages: TRANSFORM
// "target" and "tip" (camera frame, mm, as the protocol has lengths), IMAGE "endoscope" (8 bit grey) at most 25 times a
// second. Everything is sent from a thread of its own: a client that is slow or dead is dropped and never slows the
// loop.
#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core.hpp>

namespace heartservo::tools {

struct IgtlSnapshot {
  double time_s = 0;
  bool has_target = false;  ///< seen in this frame
  bool has_tip = true;      ///< there is a tool
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity(), T_camera_tip = Eigen::Isometry3d::Identity();
  cv::Mat grey;  ///< CV_8UC1, or empty; read only during publish()
};

class IgtlStream {
 public:
  /// Waits for clients on a TCP port of this machine. Throws DeviceError when the port cannot be had.
  explicit IgtlStream(int port);
  ~IgtlStream();
  IgtlStream(const IgtlStream&) = delete;
  IgtlStream& operator=(const IgtlStream&) = delete;

  /// Takes a copy and returns at once. What was not yet sent is replaced: clients get the newest.
  void publish(const IgtlSnapshot& snapshot);

  struct Counts {
    long published = 0, sent = 0;          ///< snapshots; sent: to at least one client
    int clients = 0, dropped_clients = 0;  ///< now; because they did not take what was sent, or went away
  };
  Counts counts() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace heartservo::tools
