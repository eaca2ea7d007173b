// Training of the embedded prior: its data, tokenizer, autoencoder, text encoder and U-Net.
#pragma once

#include "item3d/prior/data/captions.h"
#include "item3d/prior/training/settings.h"

#include <vector>

namespace item3d {

/// Returns the words that all tokenizers of the prior know.
std::vector<WordCount> prior_words(const TrainSettings& settings);

/// Runs the whole training, fills settings.output and measures the prior. Process 0 makes the data
/// and writes all files. The other processes receive the data from process 0.
void train_prior(const TrainSettings& settings);

}  // namespace item3d
