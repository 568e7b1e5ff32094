// Everything of the rigid-body dynamics core except URDF (rbd/urdf/urdf.h).
#pragma once

#include "rbd/algorithm/aba.h"
#include "rbd/algorithm/centroidal.h"
#include "rbd/algorithm/cholesky.h"
#include "rbd/algorithm/configuration.h"
#include "rbd/algorithm/crba.h"
#include "rbd/algorithm/external_wrench.h"
#include "rbd/algorithm/jacobian.h"
#include "rbd/algorithm/kinematics.h"
#include "rbd/algorithm/minverse.h"
#include "rbd/algorithm/rnea.h"
#include "rbd/model/data.h"
#include "rbd/model/model.h"
#include "rbd/model/random_tree.h"
#include "rbd/model/sample_models.h"
#include "rbd/spatial/spatial.h"
