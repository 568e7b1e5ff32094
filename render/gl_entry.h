// The entry points of OpenGL 3.3 core that the renderer uses, by their usual names, found at run time:
// neither OSMesa nor EGL is linked, the one that is found is used (context.h).
#pragma once

#include <GL/glcorearb.h>

namespace lab::render {

// All entries of the program, in a list that needs no order of construction.
class GlEntry {
 public:
  // Fills all entries. Throws std::runtime_error that names one which `find` does not know.
  static void load(void* (*find)(const char* name));

 protected:
  explicit GlEntry(const char* name) : name_(name), next_(first_) { first_ = this; }
  void* address_ = nullptr;

 private:
  const char* name_;
  GlEntry* next_;
  static constinit inline GlEntry* first_ = nullptr;
};

// Called like the function it stands for.
template <class Function>
class Gl : public GlEntry {
 public:
  explicit Gl(const char* name) : GlEntry(name) {}
  operator Function() const { return reinterpret_cast<Function>(address_); }
};

// To add a function, add a line.
inline Gl<PFNGLACTIVETEXTUREPROC> glActiveTexture{"glActiveTexture"};
inline Gl<PFNGLATTACHSHADERPROC> glAttachShader{"glAttachShader"};
inline Gl<PFNGLBINDBUFFERPROC> glBindBuffer{"glBindBuffer"};
inline Gl<PFNGLBINDFRAMEBUFFERPROC> glBindFramebuffer{"glBindFramebuffer"};
inline Gl<PFNGLBINDSAMPLERPROC> glBindSampler{"glBindSampler"};
inline Gl<PFNGLBINDTEXTUREPROC> glBindTexture{"glBindTexture"};
inline Gl<PFNGLBINDVERTEXARRAYPROC> glBindVertexArray{"glBindVertexArray"};
inline Gl<PFNGLBLENDFUNCPROC> glBlendFunc{"glBlendFunc"};
inline Gl<PFNGLBLENDFUNCSEPARATEPROC> glBlendFuncSeparate{"glBlendFuncSeparate"};
inline Gl<PFNGLBLITFRAMEBUFFERPROC> glBlitFramebuffer{"glBlitFramebuffer"};
inline Gl<PFNGLBUFFERDATAPROC> glBufferData{"glBufferData"};
inline Gl<PFNGLCHECKFRAMEBUFFERSTATUSPROC> glCheckFramebufferStatus{"glCheckFramebufferStatus"};
inline Gl<PFNGLCLEARPROC> glClear{"glClear"};
inline Gl<PFNGLCLEARBUFFERFVPROC> glClearBufferfv{"glClearBufferfv"};
inline Gl<PFNGLCLEARCOLORPROC> glClearColor{"glClearColor"};
inline Gl<PFNGLCOLORMASKPROC> glColorMask{"glColorMask"};
inline Gl<PFNGLCOMPILESHADERPROC> glCompileShader{"glCompileShader"};
inline Gl<PFNGLCREATEPROGRAMPROC> glCreateProgram{"glCreateProgram"};
inline Gl<PFNGLCREATESHADERPROC> glCreateShader{"glCreateShader"};
inline Gl<PFNGLDELETEBUFFERSPROC> glDeleteBuffers{"glDeleteBuffers"};
inline Gl<PFNGLDELETESHADERPROC> glDeleteShader{"glDeleteShader"};
inline Gl<PFNGLDELETETEXTURESPROC> glDeleteTextures{"glDeleteTextures"};
inline Gl<PFNGLDELETEVERTEXARRAYSPROC> glDeleteVertexArrays{"glDeleteVertexArrays"};
inline Gl<PFNGLDEPTHFUNCPROC> glDepthFunc{"glDepthFunc"};
inline Gl<PFNGLDEPTHMASKPROC> glDepthMask{"glDepthMask"};
inline Gl<PFNGLDISABLEPROC> glDisable{"glDisable"};
inline Gl<PFNGLDRAWARRAYSPROC> glDrawArrays{"glDrawArrays"};
inline Gl<PFNGLDRAWBUFFERPROC> glDrawBuffer{"glDrawBuffer"};
inline Gl<PFNGLDRAWELEMENTSPROC> glDrawElements{"glDrawElements"};
inline Gl<PFNGLENABLEPROC> glEnable{"glEnable"};
inline Gl<PFNGLENABLEVERTEXATTRIBARRAYPROC> glEnableVertexAttribArray{"glEnableVertexAttribArray"};
inline Gl<PFNGLFLUSHPROC> glFlush{"glFlush"};
inline Gl<PFNGLFRAMEBUFFERTEXTURE2DPROC> glFramebufferTexture2D{"glFramebufferTexture2D"};
inline Gl<PFNGLFRONTFACEPROC> glFrontFace{"glFrontFace"};
inline Gl<PFNGLGENBUFFERSPROC> glGenBuffers{"glGenBuffers"};
inline Gl<PFNGLGENFRAMEBUFFERSPROC> glGenFramebuffers{"glGenFramebuffers"};
inline Gl<PFNGLGENSAMPLERSPROC> glGenSamplers{"glGenSamplers"};
inline Gl<PFNGLGENTEXTURESPROC> glGenTextures{"glGenTextures"};
inline Gl<PFNGLGENVERTEXARRAYSPROC> glGenVertexArrays{"glGenVertexArrays"};
inline Gl<PFNGLGENERATEMIPMAPPROC> glGenerateMipmap{"glGenerateMipmap"};
inline Gl<PFNGLGETERRORPROC> glGetError{"glGetError"};
inline Gl<PFNGLGETPROGRAMINFOLOGPROC> glGetProgramInfoLog{"glGetProgramInfoLog"};
inline Gl<PFNGLGETPROGRAMIVPROC> glGetProgramiv{"glGetProgramiv"};
inline Gl<PFNGLGETSHADERINFOLOGPROC> glGetShaderInfoLog{"glGetShaderInfoLog"};
inline Gl<PFNGLGETSHADERIVPROC> glGetShaderiv{"glGetShaderiv"};
inline Gl<PFNGLGETSTRINGPROC> glGetString{"glGetString"};
inline Gl<PFNGLGETUNIFORMLOCATIONPROC> glGetUniformLocation{"glGetUniformLocation"};
inline Gl<PFNGLLINKPROGRAMPROC> glLinkProgram{"glLinkProgram"};
inline Gl<PFNGLMULTIDRAWELEMENTSPROC> glMultiDrawElements{"glMultiDrawElements"};
inline Gl<PFNGLPIXELSTOREIPROC> glPixelStorei{"glPixelStorei"};
inline Gl<PFNGLPOLYGONOFFSETPROC> glPolygonOffset{"glPolygonOffset"};
inline Gl<PFNGLREADBUFFERPROC> glReadBuffer{"glReadBuffer"};
inline Gl<PFNGLREADPIXELSPROC> glReadPixels{"glReadPixels"};
inline Gl<PFNGLSAMPLERPARAMETERIPROC> glSamplerParameteri{"glSamplerParameteri"};
inline Gl<PFNGLSCISSORPROC> glScissor{"glScissor"};
inline Gl<PFNGLSHADERSOURCEPROC> glShaderSource{"glShaderSource"};
inline Gl<PFNGLTEXIMAGE2DPROC> glTexImage2D{"glTexImage2D"};
inline Gl<PFNGLTEXPARAMETERIPROC> glTexParameteri{"glTexParameteri"};
inline Gl<PFNGLUNIFORM1FPROC> glUniform1f{"glUniform1f"};
inline Gl<PFNGLUNIFORM1IPROC> glUniform1i{"glUniform1i"};
inline Gl<PFNGLUNIFORM2FVPROC> glUniform2fv{"glUniform2fv"};
inline Gl<PFNGLUNIFORM3FVPROC> glUniform3fv{"glUniform3fv"};
inline Gl<PFNGLUNIFORM4FVPROC> glUniform4fv{"glUniform4fv"};
inline Gl<PFNGLUNIFORMMATRIX3FVPROC> glUniformMatrix3fv{"glUniformMatrix3fv"};
inline Gl<PFNGLUNIFORMMATRIX4FVPROC> glUniformMatrix4fv{"glUniformMatrix4fv"};
inline Gl<PFNGLUSEPROGRAMPROC> glUseProgram{"glUseProgram"};
inline Gl<PFNGLVERTEXATTRIBPOINTERPROC> glVertexAttribPointer{"glVertexAttribPointer"};
inline Gl<PFNGLVIEWPORTPROC> glViewport{"glViewport"};

}  // namespace lab::render
