"""What a pad is: its coding, its file form, its layout in millimetres.

May import only `padstudio.errors`.
"""
