"""LeRobot's format, version 3: numbers and depth in parquet files, images as videos. Without PyTorch."""

from __future__ import annotations

import io
import json
import pathlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError
from ramp.demos import statistics
from ramp.demos.episode import DEPTH_UNIT, Description, Episode

VERSION = "v3.0"
"""``codebase_version`` of the format."""
CODEC = "libx264"
QUALITY = {"g": "2", "crf": "18"}
"""Each second picture is whole, so that single ones are found fast; errors of about 2 of 255."""
VIDEO_SIZE = 200
"""A video file that is larger, MB, is followed by another one."""
DATA = "data/chunk-000/file-000.parquet"
VIDEO = "videos/{key}/chunk-000/file-{file:03d}.mp4"


class Videos:
    """The videos of one camera: episodes in a row, in as few files as their size allows."""

    def __init__(self, folder: pathlib.Path, key: str, rate: int) -> None:
        self.folder, self.key, self.rate = folder, key, rate
        self.file = -1
        self.frames = 0
        self.container: Any = None
        self.stream: Any = None

    def _path(self) -> pathlib.Path:
        return self.folder / VIDEO.format(key=self.key, file=self.file)

    def add(self, images: NDArray[np.uint8]) -> dict[str, Any]:
        """Adds an episode; the columns that tell where it is."""
        import av

        if self.container is not None and self._path().stat().st_size > VIDEO_SIZE * 1_000_000:
            self.close()
        if self.container is None:
            self.file, self.frames = self.file + 1, 0
            self._path().parent.mkdir(parents=True, exist_ok=True)
            self.container = av.open(str(self._path()), "w", format="mp4")
            self.stream = self.container.add_stream(CODEC, rate=self.rate)
            self.stream.height, self.stream.width = images.shape[1:3]
            self.stream.pix_fmt = "yuv420p"
            self.stream.options = QUALITY
        for image in images:
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="rgb24")
            self.container.mux(self.stream.encode(frame))
        first, self.frames = self.frames, self.frames + len(images)
        head = f"videos/{self.key}"
        return {
            f"{head}/chunk_index": 0,
            f"{head}/file_index": self.file,
            f"{head}/from_timestamp": first / self.rate,
            f"{head}/to_timestamp": self.frames / self.rate,
        }

    def close(self) -> None:
        """Ends the file that is open."""
        if self.container is not None:
            self.container.mux(self.stream.encode())
            self.container.close()
            self.container = None


def write(folder: pathlib.Path, description: Description, episodes: Iterable[Episode]) -> None:
    """Writes a data set into a folder."""
    import pyarrow
    import pyarrow.parquet as parquet

    (folder / "meta/episodes/chunk-000").mkdir(parents=True)
    (folder / DATA).parent.mkdir(parents=True)
    keys = {key: f"observation.images.{key}" for key in description.cameras().values()}
    depth_keys = {key: f"observation.images.{key}_depth" for key in description.deep().values()}
    videos = {key: Videos(folder, name, description.rate) for key, name in keys.items()}
    totals = {name: statistics.Counts.of_colours() for name in keys.values()}
    totals |= {name: statistics.Counts.of_depths() for name in depth_keys.values()}
    tasks: dict[str, int] = {}
    rows: list[dict[str, Any]] = []
    columns: dict[str, list[NDArray[Any]]] = {}
    writer: Any = None
    frames = 0
    for index, episode in enumerate(episodes):
        numbers = _columns(episode, index, frames, description.rate, tasks)
        table = _table(numbers)
        for key, name in depth_keys.items():
            table = table.append_column(name, _depth_column(episode.depths[key][:-1]))
        if writer is None:
            writer = parquet.ParquetWriter(folder / DATA, table.schema)
        writer.write_table(table)
        for name, values in numbers.items():
            columns.setdefault(name, []).append(values)
        row = _row(episode, index, frames)
        for name in ("observation.state", "action"):
            row |= {f"stats/{name}/{what}": value for what, value in statistics.of_rows(numbers[name]).items()}
        for key, name in keys.items():
            images = episode.images[key][:-1]
            row |= videos[key].add(images)
            row |= _count(name, images, statistics.Counts.of_colours(), totals)
        for key, name in depth_keys.items():
            row |= _count(name, episode.depths[key][:-1], statistics.Counts.of_depths(), totals)
        rows.append(row)
        frames += len(episode)
    if writer is None:
        raise InputError("there are no episodes to write")
    writer.close()
    for video in videos.values():
        video.close()
    parquet.write_table(pyarrow.Table.from_pylist(rows), folder / "meta/episodes/chunk-000/file-000.parquet")
    _write_tasks(folder, tasks)
    told = {name: statistics.of_rows(np.concatenate(values)) for name, values in columns.items()}
    told |= {name: counts.told() for name, counts in totals.items()}
    (folder / "meta/stats.json").write_text(json.dumps(told), encoding="utf-8")
    info = _info(description, len(rows), frames, len(tasks))
    (folder / "meta/info.json").write_text(json.dumps(info, indent=1), encoding="utf-8")


def _columns(episode: Episode, index: int, first: int, rate: int, tasks: dict[str, int]) -> dict[str, NDArray[Any]]:
    """The columns of an episode, whose frames are numbered from ``first`` in the whole data set."""
    count = len(episode)
    task = tasks.setdefault(episode.facts["task"], len(tasks))
    frame = np.arange(count)
    last = frame == count - 1
    return {
        "observation.state": episode.state()[:-1],
        "action": episode.actions,
        "next.reward": episode.rewards,
        "next.done": last,
        "next.success": last & bool(episode.facts["success"]),
        "timestamp": (frame / rate).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.full(count, index),
        "index": first + frame,
        "task_index": np.full(count, task),
    }


def _table(columns: dict[str, NDArray[Any]]) -> Any:
    """Columns as a table: vectors as lists of a fixed size."""
    import pyarrow

    def column(values: NDArray[Any]) -> Any:
        if values.ndim == 1:
            return pyarrow.array(values)
        flat = pyarrow.array(np.ascontiguousarray(values, np.float32).ravel())
        return pyarrow.FixedSizeListArray.from_arrays(flat, values.shape[1])

    return pyarrow.table({name: column(values) for name, values in columns.items()})


def _depth_column(images: NDArray[np.uint16]) -> Any:
    """Depth images as files of TIFF with distances in m, each with its bytes and without a path."""
    import PIL.Image
    import pyarrow

    rows = []
    for image in images:
        file = io.BytesIO()
        distances = image[..., 0].astype(np.float32) * np.float32(DEPTH_UNIT)
        PIL.Image.fromarray(distances).save(file, format="TIFF", compression="tiff_adobe_deflate")
        rows.append({"bytes": file.getvalue(), "path": None})
    return pyarrow.array(rows, pyarrow.struct([("bytes", pyarrow.binary()), ("path", pyarrow.string())]))


def _count(
    name: str, images: NDArray[Any], own: statistics.Counts, totals: dict[str, statistics.Counts]
) -> dict[str, Any]:
    """Counts the images of an episode, also in the totals: the columns with their statistics."""
    own.add(images)
    totals[name] += own
    return {f"stats/{name}/{what}": value for what, value in own.told().items()}


def _row(episode: Episode, index: int, first: int) -> dict[str, Any]:
    """What ``meta/episodes`` says of an episode, without its statistics and videos."""
    return {
        "episode_index": index,
        "tasks": [episode.facts["task"]],
        "length": len(episode),
        "dataset_from_index": first,
        "dataset_to_index": first + len(episode),
        "data/chunk_index": 0,
        "data/file_index": 0,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
        "ramp/seed": int(episode.facts["seed"]),
        "ramp/success": bool(episode.facts["success"]),
    }


def _write_tasks(folder: pathlib.Path, tasks: dict[str, int]) -> None:
    """Writes the tasks. The published reader takes them as a frame of pandas with the task as its index."""
    import pyarrow
    import pyarrow.parquet as parquet

    def column(name: str, kind: str, numpy_type: str) -> dict[str, Any]:
        told = {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": numpy_type}
        return {**told, "metadata": None}

    table = pyarrow.table(
        {"task_index": pyarrow.array(list(tasks.values()), pyarrow.int64()), "task": pyarrow.array(list(tasks))}
    )
    pandas = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [column("task_index", "int64", "int64"), column("task", "unicode", "object")],
        "pandas_version": "2.0.0",
    }
    meta = {b"pandas": json.dumps(pandas).encode()}
    parquet.write_table(table.replace_schema_metadata(meta), folder / "meta/tasks.parquet")


def _info(description: Description, episodes: int, frames: int, tasks: int) -> dict[str, Any]:
    """``meta/info.json``."""
    features: dict[str, Any] = {
        "observation.state": _feature("float32", [len(description.state_names())], description.state_names()),
        "action": _feature("float32", [len(description.actions)], list(description.actions)),
        "next.reward": _feature("float32", [1]),
        "next.done": _feature("bool", [1]),
        "next.success": _feature("bool", [1]),
        "timestamp": _feature("float32", [1]),
    }
    features |= {name: _feature("int64", [1]) for name in ("frame_index", "episode_index", "index", "task_index")}
    size = description.size
    for key in description.cameras().values():
        video = {
            "video.height": size, "video.width": size, "video.channels": 3, "video.codec": "h264",
            "video.pix_fmt": "yuv420p", "video.is_depth_map": False, "video.fps": description.rate,
            "has_audio": False,
        }  # fmt: skip
        shape = _feature("video", [size, size, 3], ["height", "width", "channels"])
        features[f"observation.images.{key}"] = {**shape, "info": video}
    for key in description.deep().values():
        shape = _feature("image", [size, size, 1], ["height", "width", "channels"])
        features[f"observation.images.{key}_depth"] = {**shape, "info": {"is_depth_map": True, "depth_unit": "m"}}
    return {
        "codebase_version": VERSION,
        "robot_type": "panda",
        "total_episodes": episodes,
        "total_frames": frames,
        "total_tasks": tasks,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": VIDEO_SIZE,
        "fps": description.rate,
        "splits": {"train": f"0:{episodes}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4" if size else None,
        "features": features,
    }


def _feature(dtype: str, shape: list[int], names: list[str] | None = None) -> dict[str, Any]:
    return {"dtype": dtype, "shape": shape, "names": names}


def actions(folder: pathlib.Path) -> Iterator[NDArray[np.float32]]:
    """The actions of each episode of a data set."""
    import pyarrow.parquet as parquet

    table = parquet.read_table(folder / DATA, columns=["action", "episode_index"])
    rows = np.stack(table["action"].to_numpy(zero_copy_only=False)).astype(np.float32)
    episodes = table["episode_index"].to_numpy()
    for index in np.unique(episodes):
        yield rows[episodes == index]
