// The neural textures before and after an edit, as its layer stores them: in half precision, and of
// the second one's table only the rows that the edit changed.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/layers/layer.h"

namespace item3d {

/// Both fields of an edit, with equal options.
struct EditFields {
    NeuralTexture fitted{nullptr};  ///< before the edit
    NeuralTexture field{nullptr};   ///< after it
};

/// Sets layer.field and layer.parameters: "fitted.NAME" and "field.NAME" of
/// NeuralTextureImpl::named_parameters(), float16; of field's table only the rows that the edit
/// changed, "field.rows" [R] int32 and "field.values" [R, features].
void put_fields(const EditFields& fields, EditLayer& layer);

/// Returns the fields, in half precision, on the CPU. Parameters that the edit did not change are
/// equal in both. Throws InputError where the layer's tensors do not match its options.
EditFields get_fields(const EditLayer& layer);

}  // namespace item3d
