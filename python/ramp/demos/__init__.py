"""Demonstrations: recorded episodes as data sets for learning, and those data sets played again.

``ramp demos`` and ``ramp replay --dataset`` start this package. A data set is made of the episodes of a skill
in its environment, of the episodes of a goal, or of logs. Its formats are LeRobot v3, HDF5 in the layout of
robomimic, and zarr in the layout of diffusion policies. It needs the extra ``data``:
``pip install 'ramp-benchmark[data]'``.

``episode`` is what all share; ``recording`` says what a request records, with ``skills`` and ``logs``, and
``far`` does so on a cluster; ``collect`` keeps finished episodes until all are there; ``lerobot``, ``hdf5``
and ``zarr_buffer`` write and read; ``replay`` plays a data set again.
"""
