// SPDX-License-Identifier: GPL-3.0-or-later
// RAPID of one module, no external axes: robtargets count in the last wobjdata, by the last tooldata.
#include <Eigen/Geometry>
#include <sstream>

#include "tests/audit/program_axes.hpp"

namespace millpose::audit {
namespace {

/// All numbers of a text from `from` on.
std::vector<Real> NumbersIn(const std::string& text, size_t from) {
  static const std::regex number(R"([-+]?[0-9]*\.?[0-9]+(?:E[-+]?[0-9]+)?)");
  std::vector<Real> found;
  for (std::sregex_iterator it(text.begin() + static_cast<std::ptrdiff_t>(from), text.end(), number), end;
       it != end; ++it)
    found.push_back(std::stold((*it)[0]));
  return found;
}

/// x, y, z and a quaternion, its real part first.
Matrix4 QuaternionFrame(const std::vector<Real>& n) {
  Matrix4 X = Shift(n.at(0), n.at(1), n.at(2));
  X.block<3, 3>(0, 0) =
      Eigen::Quaternion<Real>(n.at(3), n.at(4), n.at(5), n.at(6)).normalized().toRotationMatrix();
  return X;
}

}  // namespace

std::vector<Target> ReadRapid(const std::map<std::string, std::string>& files, const Setup& setup) {
  if (files.size() != 1 || !setup.axes.empty())
    throw std::runtime_error("programs/rapid: read are single modules of an arm without external axes");
  const auto& [name, text] = *files.begin();
  const Axes none("rapid", setup);
  Matrix4 X_FC = Matrix4::Identity(), X_BP = Matrix4::Identity();
  std::vector<Target> targets;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const Line here{name, number, line};
    const auto numbers = [&] { return NumbersIn(line, line.find('[')); };
    if (line.starts_with("mp_tool:=")) {
      X_FC = QuaternionFrame(numbers());
    } else if (line.starts_with("mp_wobj:=")) {
      X_BP = QuaternionFrame(numbers());
    } else if (line.starts_with("MoveAbsJ ")) {
      const std::vector<Real> degrees = numbers();
      Angles angles;
      for (size_t i = 0; i < 6; ++i) angles[i] = degrees.at(i) * kDegree;
      targets.push_back(none.AtAngles(here, OfArm(setup, "rapid", angles)));
    } else if (line.starts_with("MoveL ")) {
      const Matrix4 X_CT = Inverse(X_FC) * setup.X_FT;
      targets.push_back(
          {name,
           number,
           std::nullopt,
           none.FromBelieved(here, true) * setup.X_WB * X_BP * QuaternionFrame(numbers()) * X_CT,
           {},
           {}});
    }
  }
  return targets;
}

}  // namespace millpose::audit
