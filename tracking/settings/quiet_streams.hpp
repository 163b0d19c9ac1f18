#pragma once

namespace heartservo {

/// ViSP reports on stdout, where a command's JSON goes. While one of these lives, std::cout and std::cerr write
/// nowhere, in every thread; several may live at once, in any threads, and the last to go restores both.
class QuietStreams {
 public:
  QuietStreams();
  ~QuietStreams();
  QuietStreams(const QuietStreams&) = delete;
  QuietStreams& operator=(const QuietStreams&) = delete;
};

}  // namespace heartservo
