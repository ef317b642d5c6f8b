#include "registration_classes.h"

void
bayesian_icp::fuzz::registerNormalsByClass(const RegistrationInput& input)
{
  registerByClass<pcl::PointNormal, double>(input);
}
