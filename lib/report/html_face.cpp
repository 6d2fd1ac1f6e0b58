// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "base/units.hpp"
#include "report/face_report.hpp"
#include "report/html_json.hpp"
#include "report/packed.hpp"

namespace millpose::html {
namespace {

constexpr int kMostAcross = 240;  // places of the map to either side
constexpr double kToMicrometres = 1000;

/// The lattice of the side that most places of a face are on, thinned.
class FaceLattice {
 public:
  explicit FaceLattice(const FaceRays& rays) : rays_(rays.rays) {
    std::array<size_t, 6> counts{};
    for (const SurfaceRay& ray : rays_) ++counts[static_cast<size_t>(ray.side)];
    side_ = static_cast<int>(std::ranges::max_element(counts) - counts.begin());
    bool first = true;
    for (const SurfaceRay& ray : rays_) {
      if (ray.side != side_) continue;
      low_ = first ? Eigen::Vector2i(ray.i, ray.j) : low_.cwiseMin(Eigen::Vector2i(ray.i, ray.j)).eval();
      high_ = first ? Eigen::Vector2i(ray.i, ray.j) : high_.cwiseMax(Eigen::Vector2i(ray.i, ray.j)).eval();
      first = false;
    }
    step_ = 1 + (high_ - low_).maxCoeff() / kMostAcross;
    size_ = ((high_ - low_) / step_).array() + 1;
  }

  int side() const { return side_; }
  int step() const { return step_; }
  const Eigen::Vector2i& size() const { return size_; }

  /// What the tool's errors add to each place, less its mean, µm, row by row; NaN where nothing is cut.
  std::vector<float> Added(const FaceStudy& study) const {
    std::vector<float> map(static_cast<size_t>(size_.prod()), std::numeric_limits<float>::quiet_NaN());
    for (size_t r = 0; r < rays_.size(); ++r) {
      const Eigen::Vector2i at = Eigen::Vector2i(rays_[r].i, rays_[r].j) - low_;
      const RayHeight &height = study.expected.heights[r], &flawless = study.flawless.heights[r];
      if (rays_[r].side != side_ || at.x() % step_ != 0 || at.y() % step_ != 0 || !height.IsCut() ||
          !flawless.IsCut())
        continue;
      map[static_cast<size_t>(at.y() / step_) * static_cast<size_t>(size_.x()) +
          static_cast<size_t>(at.x() / step_)] =
          static_cast<float>(kToMicrometres *
                             (height.height - flawless.height - study.expected.figures.added.level));
    }
    return map;
  }

 private:
  const std::vector<SurfaceRay>& rays_;
  int side_ = 0, step_ = 1;
  Eigen::Vector2i low_ = Eigen::Vector2i::Zero(), high_ = Eigen::Vector2i::Zero(),
                  size_ = Eigen::Vector2i::Ones();
};

}  // namespace

Json FaceMapJson(const HtmlInput& input) {
  if (!input.face) return nullptr;
  const FaceReport& face = *input.face;
  const FaceLattice lattice(face.rays);
  const int axis = lattice.side() % 3;
  const char* names = "xyz";
  const auto map = [&](const FaceStudy& study) {
    return Json{{"added_um", PackFloats(lattice.Added(study))},
                {"level_um", kToMicrometres * study.expected.figures.added.level}};
  };
  Json texts;
  for (const auto& [word, language] : kLanguageWords) texts[word] = FaceText(face, language);
  return {{"text", texts},
          {"across", std::string(1, names[(axis + 1) % 3])},
          {"up", std::string(1, names[(axis + 2) % 3])},
          {"spacing_mm", lattice.step() * face.rays.spacing},
          {"nx", lattice.size().x()},
          {"ny", lattice.size().y()},
          {"plan", map(face.plan)},
          {"fixed", face.fixed ? Json(map(*face.fixed)) : Json(nullptr)},
          {"fixed_deg", face.fixed ? Json(RadToDeg(*face.rotation)) : Json(nullptr)}};
}

}  // namespace millpose::html
