"""Opens the copy of a scene in a Blender of its own, and writes scene.glb and export.json: see ``export/job.py``.

    blender --background --factory-startup --python main.py -- FOLDER

The user's Blender and scene are left alone: a render there runs beside the user interface, where nothing may be
changed, and the glTF exporter needs the main thread.
"""

import os
import sys
import traceback

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

try:
    from export import job

    job.run(sys.argv[sys.argv.index("--") + 1])
except BaseException as problem:  # else Blender exits with 0
    traceback.print_exc()
    print("wavepath: error: export: %s" % problem, file=sys.stderr, flush=True)
    os._exit(1)
