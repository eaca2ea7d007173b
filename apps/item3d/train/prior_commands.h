// The parts of `item3d prior` that have files of their own.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

/// `prior pull`: a prior from the Hugging Face hub into its cache.
void add_prior_pull(CLI::App& prior);
/// `prior verify`: what a folder holds, and whether an edit can use it.
void add_prior_verify(CLI::App& prior);

/// `prior evaluate`: how good a prior is, in numbers and pictures.
void add_prior_evaluate(CLI::App& prior);
/// `prior list`: the names that --prior takes.
void add_prior_list(CLI::App& prior);

}  // namespace item3d
