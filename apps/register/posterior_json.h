/** \file
 * \brief posterior.json: everything about a run but the draws.
 */
#pragma once

#include "register/run.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace bayesian_icp::app {

/** \brief The document as text. Lengths are in metres, angles in radians; numbers that
 * are not finite are null. */
std::string
posteriorJson(const Run& run);

/** \brief Parts of the document: a cloud, ICP's result, a mean pose, the final
 * transformation, a covariance with its convention in words. */
nlohmann::ordered_json
cloudJson(const io::CloudFile& cloud);
nlohmann::ordered_json
icpJson(const RegistrationResult& result);
nlohmann::ordered_json
meanJson(const Vector6d& mean);
nlohmann::ordered_json
finalTransformationJson(const RegistrationResult& result);
nlohmann::ordered_json
covarianceJson(CovarianceConvention convention, const Matrix6d& matrix);

} // namespace bayesian_icp::app
