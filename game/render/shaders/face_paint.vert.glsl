// mm from the head's centre to the 340 mm texture: u = (x+170)/340, v = (140-y)/340 downward.
in vec2 position;
in vec4 ink;
out vec4 v_ink;
void main() {
    v_ink = ink;
    gl_Position = vec4(position.x / 170.0, (140.0 - position.y) / 170.0 - 1.0, 0.0, 1.0);
}
