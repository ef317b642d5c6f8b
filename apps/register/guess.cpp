#include "register/guess.h"

#include "io/motion.h"

namespace bayesian_icp::app {

Eigen::Matrix4d
readGuess(const std::string& text)
{
  return io::readMotion("guess", text);
}

} // namespace bayesian_icp::app
