#pragma once
#include <memory>
#include <string>

#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

/// Both views of a stereo endoscope, frame by frame: the frames of `left` with `right`'s pictures in Frame::right (empty
/// where they cannot be read; the note says why). Throws InputError: the pictures have other sizes, or one view has
/// fewer frames than the other, here where both are counted and else from next().
std::unique_ptr<FrameSource> pair_views(std::unique_ptr<FrameSource> left, std::unique_ptr<FrameSource> right);

}  // namespace heartservo::tracking
