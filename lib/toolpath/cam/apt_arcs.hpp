// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "toolpath/cam/apt_motion.hpp"

namespace millpose {

/// CIRCLE/xc,yc,zc,i,j,k[,r]; NX adds total tolerance, ratio, diameter and corner radius of the tool and
/// means a clockwise turn about the axis, "TIMES,n" with n turns begun; MOVARC with "ANGLE,a" turns
/// right-handed about the axis by so many degrees. Throws InputError.
AptCircle ReadCircle(const AptStatement& statement, const AptSystem& system);

/// CATIA: "TLON,GOFWD/ (CIRCLE/ xc,yc,zc,r),ON,(LINE/ xc,yc,zc,xe,ye,ze)" after INDIRV, "ON,2,INTOF" for the
/// whole circle: the circle, and where the motion ends in the part (mm). Throws InputError.
std::pair<AptCircle, Eigen::Vector3d> ReadDriveMotion(const AptStatement& statement, const AptSystem& system);

}  // namespace millpose
