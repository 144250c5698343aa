"""Each top-level folder has a README: what lives here, what may be touched, what it promises."""


def problems(files):
    folders = sorted({path.split("/")[0] for path in files if "/" in path and not path.startswith(".")})
    wanted = ["README.md"] + [f"{folder}/README.md" for folder in folders]
    return [f"{path}: missing" for path in wanted if not files.get(path, "").strip()]
