// The model that the controller uses: the nominal one with the errors of `controller.model`. Only the
// inertias of bodies differ; joints, frames, limits and rotors are nominal.
#pragma once
#include <rbd/model/model.h>

#include "lab/experiment/experiment.h"

namespace lab::controller {

/// First `without` removes bodies, then `com_shift` moves centres of mass, then `mass_scale` scales all of them.
/// A body is named by its link, or by a joint: then all links rigidly attached to it. Throws ExperimentError for
/// a name that is not a body.
rbd::Model own_model(const Experiment&, const rbd::Model& nominal);

}  // namespace lab::controller
