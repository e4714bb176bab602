// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/camera.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "posefusion/core/error.hpp"

namespace pf {

std::optional<LensModel> lensModelNamed(const std::string& name) {
  for (const char* known : {"plumb_bob", "rational_polynomial", "PinHole"}) {
    if (name == known) return LensModel::kPolynomial;
  }
  for (const char* known : {"equidistant", "fisheye", "KannalaBrandt8"}) {
    if (name == known) return LensModel::kEquidistant;
  }
  return std::nullopt;
}

bool PinholeCamera::isDistorted() const {
  if (lens == LensModel::kEquidistant) return true;
  for (const double d : distortion) {
    if (d != 0.0) return true;
  }
  return false;
}

const char* PinholeCamera::lensName() const {
  if (lens == LensModel::kEquidistant) return "equidistant";
  const bool rational = distortion[5] != 0.0 || distortion[6] != 0.0 || distortion[7] != 0.0;
  return rational ? "rational_polynomial" : "plumb_bob";
}

std::size_t PinholeCamera::lensCoefficients() const {
  if (lens == LensModel::kEquidistant) return 4;
  return lensName() == std::string("plumb_bob") ? 5 : 8;
}

PinholeCamera PinholeCamera::withoutDistortion() const {
  PinholeCamera straight = *this;
  straight.lens = LensModel::kPolynomial;
  straight.distortion = {};
  return straight;
}

PinholeCamera PinholeCamera::shrunk(int factor) const {
  PinholeCamera small = *this;
  small.width = width / factor;
  small.height = height / factor;
  small.fx = fx / factor;
  small.fy = fy / factor;
  // The centre of the small pixel 0 lies at (factor - 1) / 2 in the large image.
  small.cx = (cx - 0.5 * (factor - 1)) / factor;
  small.cy = (cy - 0.5 * (factor - 1)) / factor;
  return small;
}

bool PinholeCamera::operator==(const PinholeCamera& other) const {
  return width == other.width && height == other.height && fx == other.fx && fy == other.fy &&
         cx == other.cx && cy == other.cy && lens == other.lens && distortion == other.distortion;
}

bool isSameCamera(const PinholeCamera& a, const PinholeCamera& b) {
  constexpr double kSame_px = 0.01;
  if (a.width != b.width || a.height != b.height || a.lens != b.lens ||
      a.distortion != b.distortion) {
    return false;
  }
  for (const double u : {-0.5, a.width - 0.5}) {
    for (const double v : {-0.5, a.height - 0.5}) {
      const Eigen::Vector2d there = b.project(a.unproject(u, v, 1.0));
      // Written so that what is no number differs.
      if (!((there - Eigen::Vector2d(u, v)).norm() <= kSame_px)) return false;
    }
  }
  return true;
}

std::string describe(const PinholeCamera& c) {
  std::ostringstream out;
  out << std::setprecision(8) << c.width << " x " << c.height << ", fx " << c.fx << " fy " << c.fy
      << " cx " << c.cx << " cy " << c.cy;
  return out.str();
}

// In widths of the image: 1 / (2 tan(85 degrees)).
constexpr double kLeastFocalLength = 0.0437;

void validate(const PinholeCamera& camera) {
  require(camera.width > 0, "camera: width", camera.width, "more than 0 pixels");
  require(camera.height > 0, "camera: height", camera.height, "more than 0 pixels");
  require(std::isfinite(camera.fx) && camera.fx > 0, "camera: fx", camera.fx,
          "a focal length above 0");
  require(std::isfinite(camera.fy) && camera.fy > 0, "camera: fy", camera.fy,
          "a focal length above 0");
  // 525 that was written as 5.25, or a length in metres.
  require(camera.fx > kLeastFocalLength * camera.width, "camera: fx", camera.fx,
          "a focal length in pixels, of a view of less than 170 degrees");
  require(camera.fy > kLeastFocalLength * camera.height, "camera: fy", camera.fy,
          "a focal length in pixels, of a view of less than 170 degrees");
  require(camera.cx > 0 && camera.cx < camera.width, "camera: cx", camera.cx,
          "a column of the image");
  require(camera.cy > 0 && camera.cy < camera.height, "camera: cy", camera.cy,
          "a row of the image");
  for (const double d : camera.distortion) {
    require(std::isfinite(d), "camera: a distortion coefficient", d, "a finite number");
  }
}

}  // namespace pf
