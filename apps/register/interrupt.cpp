#include "register/interrupt.h"

#include <csignal>

namespace bayesian_icp::app {

namespace {

volatile std::sig_atomic_t was_interrupted = 0;

void
remember(int)
{
  was_interrupted = 1;
}

} // namespace

void
catchInterrupt()
{
  struct sigaction action = {};
  if (sigaction(SIGINT, nullptr, &action) == 0 && action.sa_handler == SIG_IGN)
    return;
  action = {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
}

bool
wasInterrupted()
{
  return was_interrupted != 0;
}

} // namespace bayesian_icp::app
