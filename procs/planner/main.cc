#include "lab/run/shell.h"
#include "procs/planner/role.h"

int main(int argc, char** argv) {
  return lab::follower_main(argc, argv, lab::kPlanner, lab::planner::make_role);
}
