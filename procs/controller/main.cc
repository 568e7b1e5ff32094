#include "lab/run/shell.h"
#include "procs/controller/role.h"

int main(int argc, char** argv) {
  return lab::follower_main(argc, argv, lab::kController,
                            [](lab::FollowerConfig config, lab::Publish publish) {
                              return lab::controller::make_role(std::move(config), std::move(publish));
                            });
}
