#!/usr/bin/env python3
"""Measures what each choice of the embedded prior's training is worth, by short trainings that differ in one option.

    bench/prior_ablation.py ITEM3D OUTPUT --samples 40000 --data 40000

Every contender is trained with the same seed and number of images. The diffusion classifier then measures it on
held-out shapes: the share of images whose word has the lowest denoising loss among at most 31 of its kind. Finished
trainings are kept, so a run that was stopped continues. Writes OUTPUT/ablation.json and prints a Markdown table.
"""
import argparse
import json
import pathlib
import shutil
import subprocess

CONTENDERS = {
    "the recipe": [],
    "depth alone": ["--condition", "depth"],
    "no shape": ["--condition", "none"],
    "epsilon": ["--prediction", "epsilon"],
    "adamw": ["--optimizer", "adamw"],
    "widths 32,64,96": ["--widths", "32,64,96"],
    "widths 64,128,192": ["--widths", "64,128,192"],
    "a third of the patterns": ["--patterns", "0.33"],
    "twice the patterns": ["--patterns", "2"],
    "128 pixels": ["--resolution", "128"],
}
# These options change the data; the other contenders learn from the same data.
OWN_DATA = ("--patterns", "--resolution")
KINDS = ("colors", "materials", "patterns", "lights")


def train(options, name, arguments):
    """Trains a contender and returns its prior.json."""
    folder = options.output / name.replace(" ", "_").replace(",", "_")
    done = folder / "prior.json"
    if done.exists() and "kinds" in json.loads(done.read_text()):
        return json.loads(done.read_text())
    first = options.output / "the_recipe"
    work = folder / "work"
    if not work.exists() and folder != first and not any(word in arguments for word in OWN_DATA):
        work.mkdir(parents=True)
        for file in ("settings.json", "autoencoder.json", "data.safetensors"):
            shutil.copy(first / "work" / file, work)
        for part in ("tokenizer", "vae"):
            shutil.copytree(first / part, folder / part)
        for file in ("model_index.json", "prior.json"):
            shutil.copy(first / file, folder)
        prior = json.loads(done.read_text())
        done.write_text(json.dumps({key: prior[key] for key in ("words", "resolution")}))
    if options.autoencoder and "--resolution" not in arguments:
        arguments = ["--autoencoder", options.autoencoder, *arguments]
    subprocess.run(
        [options.item3d, "prior", "train", "-o", folder, "--part", "diffusion", "--samples", str(options.samples),
         "--data", str(options.data), "--autoencoder-samples", str(options.autoencoder_samples),
         "--word-images", str(options.word_images), "--seed", str(options.seed), "--resume", *arguments],
        check=True)
    return json.loads(done.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("item3d")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=40000)
    parser.add_argument("--data", type=int, default=40000)
    parser.add_argument("--autoencoder-samples", type=int, default=24000)
    parser.add_argument("--autoencoder", metavar="PRIOR",
                        help="prior whose autoencoder is used, except for images of another size")
    parser.add_argument("--word-images", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", choices=CONTENDERS, default=list(CONTENDERS))
    options = parser.parse_args()
    table = {}
    for name in ["the recipe"] + [name for name in options.only if name != "the recipe"]:
        prior = train(options, name, CONTENDERS[name])
        table[name] = {
            "parameters": prior["train"]["parameters"],
            "seconds": prior["train"]["seconds"],
            "loss": prior["train"]["loss"],
            **{kind: prior["kinds"][kind]["accuracy"] for kind in KINDS},
        }
    (options.output / "ablation.json").write_text(json.dumps(table, indent=2) + "\n")
    print("| | " + " | ".join(KINDS) + " | loss | million parameters | seconds |")
    print("|---" * (len(KINDS) + 4) + "|")
    for name, row in table.items():
        cells = [f"{row[kind]:.2f}" for kind in KINDS]
        print(f"| {name} | " + " | ".join(cells) +
              f" | {row['loss']:.3f} | {row['parameters'] / 1e6:.1f} | {row['seconds']:.0f} |")


if __name__ == "__main__":
    main()
