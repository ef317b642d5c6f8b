// A point type with normals that PCL has never heard of, for users who compile the
// class themselves.
#pragma once

#include <pcl/pcl_macros.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <cstdint>

struct EchoPoint {
  PCL_ADD_POINT4D;
  float normal_x, normal_y, normal_z;
  std::uint16_t echo;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};
POINT_CLOUD_REGISTER_POINT_STRUCT(
    EchoPoint,
    (float, x, x)(float, y, y)(float, z, z)(float, normal_x, normal_x)(
        float, normal_y, normal_y)(float, normal_z, normal_z)(std::uint16_t,
                                                              echo,
                                                              echo))
