#pragma once
// The texture matrices of a window that slides over a picture, for many candidate places of equal size: a step costs a
// column (or row) out and one in, not the window. At every place they equal, count for count, what MatrixBuilder makes
// of that window.
//
// Why that is possible for run lengths, whose runs are cut at the window's border: a column at the window's edge holds
// the end pixel of one line in each of the directions 0, 45 and 135 degrees per row. Taking it away shortens the run
// that ends there by one pixel, and adding it lengthens that run by one; its length is the run's reach in the whole
// picture (RunTable), cut at the window. Runs at 90 degrees lie in the column and go or come with it.
//
//   SlidingTexture sliding(settings, 40, 40);
//   sliding.load(grey_region(frame, search_area));       // once per frame
//   sliding.place(0, 0);                                 // window's top left corner in the search area
//   do use(texture_vector(sliding.matrices())); while (sliding.move(1, 0));
#include "tracking/texture/matrices.hpp"
#include "tracking/texture/run_table.hpp"

namespace heartservo::tracking {

class SlidingTexture {
 public:
  /// Window of width x height px.
  SlidingTexture(const TextureSettings& settings, int width, int height);

  /// The picture to slide over: quantised here, with the range "own" over the whole of it and not per window. `usable`
  /// as in quantise(). At least as large as the window. Then place() has to follow. Allocates only for a larger picture
  /// than before.
  void load(const GreyRegion& grey, const GreyRegion* usable = nullptr);
  /// The same for a picture that is quantised already, to `settings.levels`; it is copied.
  void load(const LevelRegion& picture);

  /// Window's top left corner to (x, y), built afresh. The window has to lie inside the picture.
  void place(int x, int y);

  /// Moves the window; false, and nothing done, when it would leave the picture. Far moves are built afresh.
  bool move(int dx, int dy);
  bool move_to(int x, int y) { return move(x - x_, y - y_); }

  int x() const { return x_; }
  int y() const { return y_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const TextureMatrices& matrices() const { return matrices_; }

 private:
  enum class Side { LEFT, RIGHT, TOP, BOTTOM };
  void prepare();
  /// Adds (+1) or takes away (-1) the line of pixels at that side of the window, which the window includes.
  void update(Side side, int sign);

  TextureSettings settings_;
  int width_, height_, x_ = 0, y_ = 0;
  LevelImage picture_;
  RunTable runs_;
  MatrixBuilder builder_;
  TextureMatrices matrices_;
};

}  // namespace heartservo::tracking
