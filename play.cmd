@echo off
rem play.cmd -- ./play, for Windows:  play [arguments of playground]
rem                                   play test [arguments of pytest]
rem                                   play add [extras, as gis video]
rem The stamp, a copy of pyproject.toml, is written last: a start that was stopped begins again.
rem A copy of the playground in .venv (pip install without -e) is replaced by the checkout.
setlocal
set "root=%~dp0"
set "venv=%root%.venv"
set "python=%venv%\Scripts\python.exe"
set "stamp=%venv%\play-stamp.toml"
set "extras=%venv%\play-extras.txt"
set "PLAYGROUND_PROGRAM=%~0"
set "need="
if "%~1"=="test" set "need=test"
call :ensure || exit /b 1
if "%~1"=="test" goto test
if "%~1"=="add" goto add
"%venv%\Scripts\playground.exe" %*
exit /b %errorlevel%

:test
call :arguments %*
cd /d "%root%"
"%python%" -m pytest %arguments%
exit /b %errorlevel%

:add
call :arguments %*
if defined arguments goto add_some
"%python%" -I -m playground.commands.extras
exit /b %errorlevel%
:add_some
for /f "delims=" %%x in ('""%python%" -I -m playground.commands.extras %arguments%"') do set "need=%%x"
if not defined need exit /b 2
call :ensure || exit /b 1
echo play: .venv has %need% 1>&2
exit /b 0

rem Set arguments to all but the first.
:arguments
set "arguments="
:next
shift
if "%~1"=="" exit /b 0
set arguments=%arguments% %1
goto next

rem Make .venv what it must be, with the extras in need.
:ensure
set "with="
if exist "%extras%" set /p "with=" <"%extras%"
set "had=%with%"
for %%x in (%need%) do call :unite %%x
if not "%with%"=="%had%" goto install
if exist "%venv%\Lib\site-packages\playground\__init__.py" goto install
fc /b "%root%pyproject.toml" "%stamp%" >nul 2>nul && exit /b 0
:install
if exist "%python%" goto pip
set "base=py -3"
%base% -c "import sys; sys.exit(sys.version_info < (3, 11))" >nul 2>nul && goto make
set "base=python"
%base% -c "import sys; sys.exit(sys.version_info < (3, 11))" >nul 2>nul && goto make
echo play: Python 3.11 or later is needed: winget install Python.Python.3.13 1>&2
exit /b 1
:make
echo play: making .venv (the first time only) 1>&2
%base% -m venv "%venv%" || exit /b 1
:pip
echo play: installing the playground (a minute or two) 1>&2
set "list="
if defined with set "list=[%with%]"
"%python%" -m pip install --quiet --disable-pip-version-check -e "%root%.%list%" || exit /b 1
copy /y "%root%pyproject.toml" "%stamp%" >nul
if defined with >"%extras%" echo %with%
exit /b 0

rem Add an extra to with, once.
:unite
if not defined with set "with=%1" & exit /b 0
echo ,%with%,| find ",%1," >nul || set "with=%with%,%1"
exit /b 0
