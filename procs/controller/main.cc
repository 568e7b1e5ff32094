#include "procs/controller/role.h"
#include "procs/run/shell.h"

int main(int argc, char** argv) {
  return lab::follower_main(argc, argv, lab::kController, lab::controller::make_role);
}
