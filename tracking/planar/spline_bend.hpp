#pragma once
// A smooth bending of the patch: every point x of the patch moves to x + u(x), u a tensor product of uniform quadratic
// B-splines whose control points cover the patch and one row around it (free-form deformation; Rueckert et al., IEEE
// TMI 18(8), 1999, there cubic). All coordinates are those of the patch (patch.hpp).
#include <Eigen/Core>
#include <array>
#include <vector>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

/// A third spline on the same control points is the gain of the light. Control points of a patch: `columns` x `rows` of
/// them, row by row in a BendField.
class SplineBend {
 public:
  SplineBend() = default;
  /// A patch of [-half_x, half_x] x [-half_y, half_y]; cells of about `cell` in size, as many as kMaxBendPoints allows.
  SplineBend(double half_x, double half_y, double cell);

  int columns() const { return cells_x_ + 2; }
  int rows() const { return cells_y_ + 2; }
  int points() const { return columns() * rows(); }
  double cell_x() const { return 2 * half_x_ / cells_x_; }
  double cell_y() const { return 2 * half_y_ / cells_y_; }

  /// Where control point (column, row) rests: with all of them moved by an affine map, so is the patch.
  Eigen::Vector2d rest(int column, int row) const {
    return {-half_x_ + (column - 0.5) * cell_x(), -half_y_ + (row - 0.5) * cell_y()};
  }

  /// The three splines that are not 0 at a coordinate: their values, and the first one's index.
  struct Basis {
    int first = 0;
    std::array<double, 3> value{};
  };
  Basis along_x(double x) const { return basis(x, half_x_, cells_x_); }
  Basis along_y(double y) const { return basis(y, half_y_, cells_y_); }

  /// u at a point; outside the patch the border's cell goes on.
  Eigen::Vector2d offset(const BendField& field, const Eigen::Vector2d& at) const;
  /// What the field adds to the gain there.
  double gain_offset(const BendField& field, const Eigen::Vector2d& at) const;

  /// Splits x + u(x) into a homography and the bending that is left: x + u(x) = H(x + u'(x)) with u'(0) = 0, H being
  /// the homography that fits the control points best, those near the centre most (weights of a Gaussian of half the
  /// patch's half side). Returns H (lower right element 1) and turns `field` into u'; exact but for third-order terms
  /// of the perspective, of which a frame brings next to nothing.
  Eigen::Matrix3d split_homography(BendField& field) const;

  /// A second difference of control points along x, along y or mixed: sum of factor * control point. All are zero for
  /// affine maps, so their squares measure bending alone (Eilers & Marx, Statistical Science 11(2), 1996).
  struct Difference {
    std::array<int, 4> point{};
    std::array<double, 4> factor{};  ///< the last is 0 where there are only three points
  };
  std::vector<Difference> differences() const;

 private:
  static Basis basis(double x, double half, int cells);
  Eigen::Matrix3d split_once(BendField& field) const;

  double half_x_ = 1, half_y_ = 1;
  int cells_x_ = 1, cells_y_ = 1;
};

}  // namespace heartservo::tracking
