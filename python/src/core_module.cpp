#include "converters.h"

#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/exports.h>
#include <bayesian_icp/measurement.h>
#include <bayesian_icp/ros_messages.h>

#include <string>
#include <utility>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

/** The fields of a geometry_msgs/msg/PoseWithCovarianceStamped. */
struct RosMessage {
  struct {
    struct {
      std::int32_t sec;
      std::uint32_t nanosec;
    } stamp;
    std::string frame_id;
  } header;
  struct {
    struct {
      struct {
        double x, y, z;
      } position;
      struct {
        double x, y, z, w;
      } orientation;
    } pose;
    std::array<double, 36> covariance;
  } pose;
};

py::dict
rosDict(const PoseEstimate& estimate, const ExportOptions& options)
{
  using py::literals::operator""_a;
  RosMessage message;
  fillPoseWithCovarianceStamped(estimate, options, message);
  const auto& [stamp, frame_id] = message.header;
  const auto& [position, orientation] = message.pose.pose;
  const py::dict header("stamp"_a =
                            py::dict("sec"_a = stamp.sec, "nanosec"_a = stamp.nanosec),
                        "frame_id"_a = frame_id);
  const py::dict pose("position"_a = py::dict(
                          "x"_a = position.x, "y"_a = position.y, "z"_a = position.z),
                      "orientation"_a = py::dict("x"_a = orientation.x,
                                                 "y"_a = orientation.y,
                                                 "z"_a = orientation.z,
                                                 "w"_a = orientation.w));
  return py::dict(
      "header"_a = header,
      "pose"_a = py::dict("pose"_a = pose, "covariance"_a = message.pose.covariance));
}

/** \return \p T, if it is a rotation and a translation to the accuracy of 32 bits */
const Eigen::Matrix4d&
rigid(const Eigen::Matrix4d& T)
{
  if (!T.allFinite())
    throw py::value_error("the matrix is not finite");
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double skew = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm();
  const Eigen::RowVector4d last_row = T.row(3);
  if (skew > 1e-3 || R.determinant() < 0.0 ||
      !last_row.isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), 1e-5))
    throw py::value_error(
        py::str("the matrix is not a rotation and a translation: det R is {:.4g}, "
                "|R^T R - I| is {:.2g}, and the last row is {}; they must be 1, 0 and "
                "[0, 0, 0, 1]")
            .format(R.determinant(), skew, last_row));
  return T;
}

/** Releases the interpreter's lock in a function that takes long. */
using Unlocked = py::call_guard<py::gil_scoped_release>;

/** What its callers in Python, who check shapes and names, say of it is there. */
void
bindPoses(py::module_& module)
{
  const auto convention = py::arg("convention") = CovarianceConvention::Parameters;
  module.def("matrix_from_pose", &matrixOf, py::arg("pose"));
  module.def(
      "pose_from_matrix",
      [](const Eigen::Matrix4d& T) { return poseOf(rigid(T)); },
      py::arg("T_target_source"));
  module.def("pose_error", &poseError, py::arg("pose"), py::arg("mean"), convention);
  module.def(
      "pose_from_error", &poseFromError, py::arg("error"), py::arg("mean"), convention);
  module.def("mean_pose", &meanPose, Unlocked(), py::arg("draws"));
  module.def("covariance_about",
             &covarianceAbout,
             Unlocked(),
             py::arg("mean"),
             py::arg("draws"),
             convention);
  module.def(
      "convert_covariance",
      [](const Matrix6d& covariance,
         const Vector6d& mean,
         CovarianceConvention source,
         CovarianceConvention target) {
        return Matrix6d(estimateOf(mean, covariance, source).covariance(target));
      },
      py::arg("covariance"),
      py::arg("mean"),
      py::arg("source"),
      py::arg("target"));
  module.def("exp_se3", &expSE3, py::arg("twist"));
  module.def(
      "log_se3",
      [](const Eigen::Matrix4d& T) { return logSE3(rigid(T)); },
      py::arg("transform"));
  module.def("gtsam_covariance", &gtsamCovariance, py::arg("right_se3"));
  module.def("g2o_covariance", &g2oCovariance, py::arg("right_se3"));
}

void
bindDiagnostics(py::module_& module)
{
  for (const auto& [name, function] : {std::pair("rhat", &rhat),
                                       std::pair("bulk_ess", &bulkEss),
                                       std::pair("tail_ess", &tailEss),
                                       std::pair("mcse_mean", &mcseMean)})
    module.def(name, function, Unlocked(), py::arg("draws"));
}

void
bindExports(py::module_& module)
{
  module.def("ros", &rosDict, py::arg("estimate"), py::arg("options"));
  module.def("g2o", &g2oEdge, py::arg("estimate"), py::arg("options"));
  module.def("gtsam", &gtsamText, py::arg("estimate"), py::arg("options"));
  module.def("tum", &tumLine, py::arg("estimate"), py::arg("options"));
}

} // namespace

} // namespace bayesian_icp::python

PYBIND11_MODULE(_core, module)
{
  using namespace bayesian_icp::python;
  module.doc() = "The core of Bayesian ICP; use it by the package bayesian_icp.";
  module.attr("__version__") = BAYESIAN_ICP_VERSION;
  bindOptions(module);
  bindEstimate(module);
  bindPoses(module);
  bindDiagnostics(module);
  bindExports(module);
}
